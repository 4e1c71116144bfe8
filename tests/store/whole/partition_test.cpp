// Boxes for ranks: they cover the grid once, their weights are those of their cells, and they are as balanced as cells allow.
#include "store/whole/partition.hpp"

#include "store/teracell.h"
#include "store/whole/near_parts.hpp"
#include "tests/support/checked.hpp"

using namespace teracell;
using namespace teracell::testing;

namespace {

const auto kSilent = [](double) {};

struct Cut {
  Cut(uint64_t seed, int axis, uint32_t chunk_rays = 4) : random(seed), grid(random_grid(random, 40)), cells(random_cells(random, grid.cells(), 4)) {
    Metadata meta = with_tiny_chunks(metadata_of(grid, axis, 4));
    meta.chunk_rays = chunk_rays;
    store_cells(folder / "g.tcell", meta, cells);
    reader.emplace(folder / "g.tcell");
  }
  double weight(const Box& box, const std::vector<double>& weights) const {
    double sum = 0;
    Checked::for_cells(
        box, [&](int64_t x, int64_t y, int64_t z) { sum += weights[cells[static_cast<size_t>((z * grid.cells()[1] + y) * grid.cells()[0] + x)]]; });
    return sum;
  }
  TempFolder folder;
  std::mt19937_64 random;
  Grid grid;
  std::vector<Label> cells;
  std::optional<GridReader> reader;
};

// What must hold of any partition, by brute force.
void expect_sound(const Cut& c, const Partition& p) {
  const PartitionOptions& o = p.options;
  REQUIRE(static_cast<int64_t>(p.parts.size()) == o.ranks);
  const Index3 n = c.grid.cells();
  std::vector<int64_t> owner(c.cells.size(), -1);
  double total = 0;
  for (size_t rank = 0; rank < p.parts.size(); ++rank) {
    const Part& part = p.parts[rank];
    REQUIRE_FALSE(part.box.empty());
    Checked::for_cells(part.box, [&](int64_t x, int64_t y, int64_t z) {
      int64_t& cell = owner[static_cast<size_t>((z * n[1] + y) * n[0] + x)];
      REQUIRE(cell == -1);
      cell = static_cast<int64_t>(rank);
    });
    CHECK(part.weight == Approx(c.weight(part.box, o.weights)).margin(1e-6));
    total += part.weight;
    for (int d = 0; d < 3; ++d) {
      CHECK((part.box.lo[d] % o.align == 0 && (part.box.hi[d] % o.align == 0 || part.box.hi[d] == n[d])));
      CHECK((part.halo_box.lo[d] == std::max<int64_t>(0, part.box.lo[d] - o.halo) && part.halo_box.hi[d] == std::min(n[d], part.box.hi[d] + o.halo)));
    }
  }
  CHECK(std::ranges::count(owner, -1) == 0);
  CHECK(p.total == Approx(total).margin(1e-6));
  for (size_t rank = 0; rank < p.parts.size(); ++rank) {  // whose cells the halo, or a step across a face, reaches
    const Part& part = p.parts[rank];
    std::set<int64_t> expected;
    const auto see = [&](const Box& box) {
      Checked::for_cells(box, [&](int64_t x, int64_t y, int64_t z) {
        if (x >= 0 && y >= 0 && z >= 0 && x < n[0] && y < n[1] && z < n[2]) expected.insert(owner[static_cast<size_t>((z * n[1] + y) * n[0] + x)]);
      });
    };
    if (o.halo > 0) see(part.halo_box);
    else
      for (int d = 0; d < 3; ++d) {
        Box grown = part.box;
        --grown.lo[d], ++grown.hi[d];
        see(grown);
      }
    expected.erase(static_cast<int64_t>(rank));
    CHECK(std::ranges::equal(part.neighbours, expected));
  }
}

}  // namespace

TEST_CASE("Parts cover each cell once, with the weights of their cells and the neighbours that they touch") {
  for (uint64_t seed = 0; seed < rounds(12); ++seed) {
    Cut c(seed, static_cast<int>(seed % 3));
    for (const PartitionMethod method : {PartitionMethod::kBlocks, PartitionMethod::kSlabs})
      for (const int64_t align : {1, 3})
        for (const int64_t halo : {0, 2}) {
          const Index3 n = c.grid.cells();
          const int64_t most = method == PartitionMethod::kSlabs ? (std::ranges::max(n) + align - 1) / align : 40;
          const PartitionOptions o{random_int(c.random, 1, static_cast<int>(std::max<int64_t>(1, most))), method, {1, 0, 2.5, 0.25}, align, halo};
          INFO("seed " << seed << ", " << o.ranks << " ranks, align " << align);
          try {
            const Partition p = make_partition(*c.reader, o, kSilent);
            expect_sound(c, p);
            CHECK(partition_json(parse_partition(partition_json(p))) == partition_json(p));
          } catch (const OptionError& e) {  // too many ranks for so coarse cuts
            CHECK(align > 1);
            CHECK(method == PartitionMethod::kBlocks);
          }
        }
  }
}

TEST_CASE("Slabs end where the weight below is nearest to the rank's share, of several places at the one nearest to equal widths") {
  for (uint64_t seed = 0; seed < rounds(24); ++seed) {
    Cut c(100 + seed, static_cast<int>(seed % 3));
    const Index3 n = c.grid.cells();
    const auto axis = static_cast<size_t>(std::ranges::max_element(n) - n.begin());
    const int64_t align = random_int(c.random, 1, 3), places = (n[axis] + align - 1) / align,
                  ranks = random_int(c.random, 1, static_cast<int>(places));
    const PartitionOptions o{ranks, PartitionMethod::kSlabs, {1, 0, 2.5, 0.25}, align, 0};  // sums without rounding
    std::vector<double> below = {0};                                                        // of the places to cut at
    for (int64_t place = 0; place < places; ++place) {
      Box layers = c.grid.box(0);
      layers.lo[axis] = place * align, layers.hi[axis] = std::min(n[axis], (place + 1) * align);
      below.push_back(below.back() + c.weight(layers, o.weights));
    }
    const Partition p = make_partition(*c.reader, o, kSilent);
    int64_t at = 0;
    for (int64_t rank = 0; rank + 1 < ranks; ++rank) {
      const double share = static_cast<double>(rank + 1) / static_cast<double>(ranks);
      const auto badness = [&](int64_t place) {
        return std::tuple(std::abs(below[static_cast<size_t>(place)] - below.back() * share),
                          std::abs(static_cast<double>(place) - static_cast<double>(places) * share), place);
      };
      const auto open = std::views::iota(at + 1, places - (ranks - rank - 1) + 1);
      at = *std::ranges::min_element(open, {}, badness);
      INFO("seed " << seed << ", rank " << rank << " of " << ranks << ", align " << align);
      REQUIRE(p.parts[static_cast<size_t>(rank)].box.hi[axis] == at * align);
    }
  }
}

TEST_CASE("The parts do not depend on the axis of the rays where all cells weigh the same, and are balanced") {
  const TempFolder folder;
  for (int w = 0; w < 3; ++w) {
    Metadata meta = metadata_of(cube_grid_of(0, 1, 64), w, 2);
    meta.chunk_rays = 16;
    store_cells(folder / "g.tcell", meta, std::vector<Label>(64 * 64 * 64, 0));
    for (const int64_t ranks : {2, 8, 27, 64, 512}) {
      const Partition p = make_partition(GridReader(folder / "g.tcell"), {ranks, PartitionMethod::kBlocks, {1, 1}, 1, 0}, kSilent);
      double heaviest = 0;
      int64_t faces = 0;
      for (const Part& part : p.parts) {
        heaviest = std::max(heaviest, part.weight);
        const Index3 e = {part.box.hi[0] - part.box.lo[0], part.box.hi[1] - part.box.lo[1], part.box.hi[2] - part.box.lo[2]};
        faces += 2 * (e[0] * e[1] + e[1] * e[2] + e[2] * e[0]);
      }
      INFO(ranks << " ranks along " << w);
      CHECK(heaviest <= (ranks == 27 ? 1.1 : 1.05) * p.total / static_cast<double>(ranks));
      CHECK(static_cast<double>(faces) <=
            1.35 * 6 * std::pow(64 * 64 * 64 / static_cast<double>(ranks), 2. / 3) * static_cast<double>(ranks));  // compact
    }
  }
}

TEST_CASE("Of slabs, only those beside each other are compared, whatever axis they lie along") {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<Part> slabs(1000);
    for (size_t i = 0; i < slabs.size(); ++i) {
      slabs[i].box = {{0, 0, 0}, {7, 7, 7}};
      slabs[i].box.lo[axis] = static_cast<int64_t>(i) * 4, slabs[i].box.hi[axis] = static_cast<int64_t>(i + 1) * 4;
    }
    for (const int64_t reach : {0, 1, 5}) {
      int64_t compared = 0;
      for_each_near_pair(slabs, reach, [&](size_t, size_t) { ++compared; });
      CHECK(compared == (reach == 0 ? 0 : reach == 1 ? 999 : 999 + 998));
    }
  }
}

TEST_CASE("No part weighs less than nothing, whatever the weights are rounded to") {
  for (uint64_t seed = 0; seed < rounds(12); ++seed) {
    Cut c(seed, static_cast<int>(seed % 3));
    for (const int64_t ranks : {16, 150, 500})
      for (const std::vector<double>& weights : {std::vector<double>{0.3, 0.1, 0, 0.7}, {0, 0, 0.001, 0.1}, {1. / 3, 0.001, 0.3, 0}}) {
        if (ranks > static_cast<int64_t>(c.cells.size())) continue;
        const Partition p = make_partition(*c.reader, {ranks, PartitionMethod::kBlocks, weights, 1, 0}, kSilent);
        for (const Part& part : p.parts) CHECK(part.weight >= 0);
        CHECK_NOTHROW(parse_partition(partition_json(p)));
      }
  }
}

TEST_CASE("More ranks than cells, and options out of range, are refused") {
  Cut c(1, 2);
  const std::vector<double> ones(4, 1);
  CHECK_THROWS_WITH(make_partition(*c.reader, {100'000'000, PartitionMethod::kBlocks, ones, 1, 0}, kSilent), Catch::StartsWith("ranks: "));
  CHECK_THROWS_WITH(make_partition(*c.reader, {100'000, PartitionMethod::kSlabs, ones, 1, 0}, kSilent), Catch::StartsWith("ranks: "));
  CHECK_THROWS_WITH(make_partition(*c.reader, {0, PartitionMethod::kBlocks, ones, 1, 0}, kSilent), Catch::StartsWith("ranks: "));
  CHECK_THROWS_WITH(make_partition(*c.reader, {2, PartitionMethod::kBlocks, ones, 0, 0}, kSilent), Catch::StartsWith("align: "));
  CHECK_THROWS_WITH(make_partition(*c.reader, {2, PartitionMethod::kBlocks, ones, 1, -1}, kSilent), Catch::StartsWith("halo: "));
  CHECK_THROWS_WITH(make_partition(*c.reader, {2, PartitionMethod::kBlocks, {1, 1, -1, 1}, 1, 0}, kSilent), Catch::StartsWith("weight: "));
  CHECK_THROWS_WITH(make_partition(*c.reader, {2, PartitionMethod::kBlocks, {1, 1}, 1, 0}, kSilent), Catch::StartsWith("weight: "));
  CHECK_THROWS_WITH(make_partition(*c.reader, {2, PartitionMethod::kBlocks, {0, 0, 0, 0}, 1, 0}, kSilent),
                    Catch::StartsWith("weight: expected work in some cell"));
  CHECK_THROWS_WITH(make_partition(*c.reader, {2, PartitionMethod::kBlocks, ones, INT64_MAX, 0}, kSilent), Catch::StartsWith("align: "));
  CHECK_THROWS_WITH(make_partition(*c.reader, {2, PartitionMethod::kBlocks, ones, 1, INT64_MAX}, kSilent), Catch::StartsWith("halo: "));
  store_cells(c.folder / "cube.tcell", metadata_of(cube_grid_of(0, 1, 64), 0, 2), std::vector<Label>(64 * 64 * 64, 0));
  if (!kSanitized)  // each part a neighbour of all others: more than memory would hold
    CHECK_THROWS_WITH(make_partition(GridReader(c.folder / "cube.tcell"), {10'000, PartitionMethod::kBlocks, {1, 1}, 1, 64}, kSilent),
                      Catch::StartsWith("halo: "));
  // The last slab may be narrower than the others.
  for (const int64_t ranks : {5, 6}) {
    const auto slabs = [&] { return make_partition(GridReader(c.folder / "cube.tcell"), {ranks, PartitionMethod::kSlabs, {1, 1}, 15, 0}, kSilent); };
    if (ranks == 5) CHECK(std::ranges::max(slabs().parts.back().box.lo) == 60);
    else CHECK_THROWS_WITH(slabs(), Catch::Contains("at most 5"));
  }
  // Every cell a rank of its own.
  const int64_t cells = static_cast<int64_t>(c.cells.size());
  for (const Part& part : make_partition(*c.reader, {cells, PartitionMethod::kBlocks, ones, 1, 0}, kSilent).parts) REQUIRE(part.weight == 1);
  CHECK_THROWS_WITH(make_partition(*c.reader, {cells + 1, PartitionMethod::kBlocks, ones, 1, 0}, kSilent), Catch::StartsWith("ranks: "));
}

TEST_CASE("A file that is no partition, or whose boxes do not cover the grid, is refused") {
  Cut c(2, 1);
  const std::string good = partition_json(make_partition(*c.reader, {5, PartitionMethod::kBlocks, {1, 1, 1, 1}, 1, 1}, kSilent));
  for (size_t length = 0; length < good.size(); length += 7) CHECK_THROWS_AS(parse_partition(good.substr(0, length)), InputError);
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
  };
  CHECK_THROWS_AS(parse_partition(changed("\"ranks\":5", "\"ranks\":6")), InputError);
  CHECK_THROWS_AS(parse_partition(changed("\"box\":[0,0,0,", "\"box\":[1,0,0,")), InputError);
  CHECK_THROWS_AS(parse_partition(changed("\"rank\":1", "\"rank\":2")), InputError);
  CHECK_THROWS_AS(parse_partition(changed("\"blocks\"", "\"heaps\"")), InputError);
  // Numbers that are not whole, boxes with another halo than the file says, and cuts at other places.
  CHECK_THROWS_WITH(parse_partition(changed("\"ranks\":5", "\"ranks\":5.5")),
                    Catch::Contains("ranks: expected a whole number from 0 to 9223372036854775807, found 5.5"));
  CHECK_THROWS_WITH(parse_partition(changed("\"rank\":1", "\"rank\":true")),
                    Catch::Contains("parts[1].rank: expected a whole number") && Catch::EndsWith("found true"));
  CHECK_THROWS_WITH(parse_partition(changed("\"halo\":1", "\"halo\":18446744073709551615")), Catch::Contains("whole number"));
  CHECK_THROWS_WITH(parse_partition(changed("\"box\":[0,", "\"box\":[0.25,")),
                    Catch::Contains("parts[0].box[0]: expected a whole number") && Catch::EndsWith("found 0.25"));
  CHECK_THROWS_WITH(parse_partition(changed("\"cells\":[", "\"cells\":[1,")), Catch::Contains("cells: expected an array of 3, found an array of 4"));
  CHECK_THROWS_WITH(parse_partition(changed("\"halo\":1", "\"halo\":2")), Catch::Contains("halo_box"));
  CHECK_THROWS_WITH(parse_partition(changed("\"halo\":1", "\"halo\":-1")),
                    Catch::Contains("halo: expected a whole number from 0 to 2147483646, found -1"));
  CHECK_THROWS_WITH(parse_partition(changed("\"align\":1", "\"align\":7")), Catch::Contains("multiples of 7 cells"));
  CHECK_THROWS_WITH(parse_partition(changed("\"grid_hash\":\"", "\"grid_hash\":\"0")), Catch::Contains("32 hexadecimal digits"));
  CHECK_THROWS_WITH(parse_partition(changed("\"total\":", "\"total\":-")), Catch::Contains("total: expected a number of at least 0"));
  const auto part_json = [](int rank, const char* box) {
    return fmt::format(R"({{"rank":{},"box":{},"weight":1,"halo_box":{},"neighbours":[]}})", rank, box, box);
  };
  const auto two = [&](const char* a, const char* b) {
    return fmt::format(
        R"({{"schema":1,"ranks":2,"method":"slabs","align":1,"halo":0,"weights":{{"a":1}},"cells":[4,1,1],"grid_hash":"{:032}","total":4,"parts":[{},{}]}})",
        0, part_json(0, a), part_json(1, b));
  };
  CHECK_NOTHROW(parse_partition(two("[0,0,0,2,1,1]", "[2,0,0,4,1,1]")));
  CHECK_THROWS_WITH(parse_partition(two("[0,0,0,2,1,1]", "[1,0,0,3,1,1]")), Catch::Contains("ranks 0 and 1"));

  std::ofstream(c.folder / "p.json") << good;
  tc_partition* p = nullptr;
  REQUIRE(tc_partition_open((c.folder / "p.json").c_str(), &p) == TC_OK);
  const Partition expected = parse_partition(good);
  tc_plan plan;
  REQUIRE(tc_partition_plan(p, &plan, sizeof plan) == TC_OK);
  CHECK((plan.ranks == 5 && plan.align == 1 && plan.halo == 1 && plan.total == expected.total && std::ranges::equal(plan.cells, c.grid.cells())));
  CHECK((plan.method == std::string("blocks") && plan.grid_hash == c.reader->hash()));
  for (int64_t rank = 0; rank < 5; ++rank) {
    tc_part part;
    REQUIRE(tc_partition_part(p, rank, &part, sizeof part) == TC_OK);
    const Part& e = expected.parts[static_cast<size_t>(rank)];
    CHECK((std::ranges::equal(part.lo, e.box.lo) && std::ranges::equal(part.halo_hi, e.halo_box.hi) && part.weight == e.weight));
    CHECK(std::ranges::equal(std::span(part.neighbours, static_cast<size_t>(part.count)), e.neighbours));
  }
  tc_part part;
  CHECK(tc_partition_part(p, 5, &part, sizeof part) == TC_USAGE);
  tc_partition_close(p);
  std::ofstream(c.folder / "p.json") << "{}";
  CHECK(tc_partition_open((c.folder / "p.json").c_str(), &p) == TC_FORMAT);
}
