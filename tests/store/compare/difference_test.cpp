// The differences of two grids: exact for any axes of rays, chunks, threads and memory, held against the cells one by one.
#include "store/compare/difference.hpp"

#include "store/whole/info.hpp"
#include "store/whole/verify.hpp"
#include "store/write/tree_order.hpp"
#include "tests/support/checked.hpp"

using namespace teracell;
using namespace teracell::testing;

namespace {

const auto kSilent = [](const char*, double) {};

struct CellCount {
  uint64_t cells = 0;
  Box box;
  friend bool operator==(const CellCount&, const CellCount&) = default;
};
using Counts = std::map<std::pair<std::string, std::string>, CellCount>;

// Cells of a grid and what its materials are called.
struct Named {
  std::vector<Label> cells;
  std::vector<std::string> names;
  const std::string& at(size_t i) const { return names[cells[i]]; }
};

Named random_named(std::mt19937_64& random, const Grid& grid, std::vector<std::string> names) {
  const auto labels = static_cast<uint32_t>(names.size());
  return {random_cells(random, grid.cells(), labels), std::move(names)};
}

// The same with some cells changed: what is left is the same.
Named changed_a_little(std::mt19937_64& random, Named of) {
  for (Label& l : of.cells)
    if (random() % 50 == 0) l = static_cast<Label>(random() % of.names.size());
  return of;
}

Counts by_hand(const Grid& grid, const Named& a, const Named& b) {
  Counts out;
  size_t i = 0;
  Checked::for_cells(grid.box(0), [&](int64_t x, int64_t y, int64_t z) {
    const std::string &from = a.at(i), &to = b.at(i);
    ++i;
    if (from == to) return;
    CellCount& c = out[{from, to}];
    const Index3 cell = {x, y, z};
    for (int d = 0; d < 3; ++d) {
      c.box.lo[d] = c.cells == 0 ? cell[d] : std::min(c.box.lo[d], cell[d]);
      c.box.hi[d] = std::max(c.box.hi[d], cell[d] + 1);
    }
    ++c.cells;
  });
  return out;
}

Counts counts_of(const Difference& d) {
  Counts out;
  for (const Change& c : d.changes) out[{c.from, c.to}] = {static_cast<uint64_t>(c.cells), c.box};
  REQUIRE(out.size() == d.changes.size());
  return out;
}

Metadata named_metadata(const Grid& grid, int axis, const Named& of) {
  Metadata meta = metadata_of(grid, axis, static_cast<uint32_t>(of.names.size()));
  for (size_t m = 0; m < of.names.size(); ++m) meta.materials[m].name = of.names[m];
  return meta;
}

// How a grid is stored.
struct Layout {
  int axis;
  uint32_t rays, cells;
};

void stored(const std::filesystem::path& path, const Grid& grid, const Named& of, const Layout& layout) {
  Metadata meta = named_metadata(grid, layout.axis, of);
  meta.chunk_rays = layout.rays;
  meta.chunk_cells = layout.cells;
  meta.page_chunks = 2;
  store_cells(path, meta, of.cells);
}

Layout random_layout(std::mt19937_64& random, int axis) {
  return {axis, std::array<uint32_t, 4>{4, 8, 12, 64}[random() % 4], std::array<uint32_t, 4>{4, 8, 20, 65536}[random() % 4]};
}

// Compares the files, with options drawn at random, and looks at all that comes of it.
void expect_difference(const TempFolder& folder, const Grid& grid, const Named& a, const Named& b, std::mt19937_64& random) {
  const GridReader x(folder / "a.tcell"), y(folder / "b.tcell");
  DifferenceOptions options;
  options.threads = random_int(random, 1, 3);
  options.memory = std::array<size_t, 3>{1, 20000, size_t{256} << 20}[random() % 3];
  const Difference alone = find_difference(x, y, options, kSilent);
  options.output = folder / "d.tcell";
  const Difference with_file = find_difference(x, y, options, kSilent);
  const Counts expected = by_hand(grid, a, b);
  REQUIRE(counts_of(alone) == expected);
  REQUIRE(counts_of(with_file) == expected);
  REQUIRE(difference_json(alone) == difference_json(with_file));
  uint64_t differ = 0;
  for (const auto& [pair, count] : expected) differ += count.cells;
  REQUIRE(static_cast<uint64_t>(alone.cells) == a.cells.size());
  REQUIRE(static_cast<uint64_t>(alone.same) == a.cells.size() - differ);

  const GridReader d(folder / "d.tcell");
  verify(d, 1, [](double) {});
  REQUIRE(d.meta().grid == x.meta().grid);
  REQUIRE(d.meta().ray_axis == x.meta().ray_axis);
  const std::vector<uint32_t> cells = all_cells(d);
  size_t wrong = 0;
  for (size_t i = 0; i < cells.size(); ++i)
    wrong += d.meta().materials[cells[i]].name != (a.at(i) == b.at(i) ? "same" : fmt::format("{} → {}", a.at(i), b.at(i)));
  REQUIRE(wrong == 0);

  const std::string bytes = bytes_of(folder / "d.tcell");
  options.threads = random_int(random, 1, 3);
  options.memory = std::array<size_t, 2>{1, size_t{256} << 20}[random() % 2];
  find_difference(x, y, options, kSilent);
  REQUIRE(bytes_of(folder / "d.tcell") == bytes);
}

}  // namespace

TEST_CASE("differences are those of the cells, for all axes of rays, sizes of chunks, threads and memory") {
  for (uint64_t seed = 0; seed < (kSanitized ? 2 : 12); ++seed) {
    std::mt19937_64 random(seed);
    const Grid grid = random_grid(random, 40);
    const Named a = random_named(random, grid, {"air", "steel", "brass", "wood"});
    // Names in another order, one that the other grid does not have, and one that occurs twice.
    const Named b = seed % 3 == 0 ? changed_a_little(random, a) : random_named(random, grid, {"steel", "air", "wood", "cork", "air"});
    const TempFolder folder;
    for (int axis_a = 0; axis_a < 3; ++axis_a)
      for (int axis_b = 0; axis_b < 3; ++axis_b) {
        const Layout of_a = random_layout(random, axis_a),
                     of_b = random() % 2 ? random_layout(random, axis_b) : Layout{axis_b, of_a.rays, of_a.cells};
        INFO("seed " << seed << ", rays along " << axis_name(axis_a) << " and " << axis_name(axis_b) << ", chunks of " << of_a.rays << " rays, "
                     << of_a.cells << " cells and " << of_b.rays << ", " << of_b.cells);
        stored(folder / "a.tcell", grid, a, of_a);
        stored(folder / "b.tcell", grid, b, of_b);
        expect_difference(folder, grid, a, b, random);
      }
  }
}

TEST_CASE("layers across the rays of one grid, of which no memory holds all turned") {
  std::mt19937_64 random(1);
  const Grid grid = unit_grid(kSanitized ? Index3{60, 5, 200} : Index3{100, 9, 300});
  Named a{{}, {"air", "steel"}}, b = a;
  Checked::for_cells(grid.box(0), [&](int64_t x, int64_t, int64_t z) {
    a.cells.push_back(static_cast<Label>(z & 1));
    b.cells.push_back(static_cast<Label>(x == 50 ? 1 : (z / 2) & 1));
  });
  const TempFolder folder;
  for (const auto& [axis_a, axis_b] : {std::pair(2, 0), std::pair(0, 2), std::pair(2, 1), std::pair(1, 0)}) {
    if (kSanitized && axis_b != 1) continue;
    stored(folder / "a.tcell", grid, a, {axis_a, 4, 64});
    stored(folder / "b.tcell", grid, b, {axis_b, 8, 32});
    expect_difference(folder, grid, a, b, random);
  }
}

TEST_CASE("a grid has no differences from itself, and all of its cells from one of another material") {
  std::mt19937_64 random(2);
  for (const int64_t side : {1, 2, 7, 30}) {
    if (kSanitized && side == 30) continue;
    const Grid grid = cube_grid_of(-1, 0.5, side);
    const Named a = random_named(random, grid, {"air", "steel"});
    const Named other{std::vector<Label>(a.cells.size(), 0), {"water"}};
    const TempFolder folder;
    for (const int axis : {0, 2}) {
      stored(folder / "a.tcell", grid, a, {2, 4, 8});
      stored(folder / "b.tcell", grid, a, {axis, 4, 8});
      expect_difference(folder, grid, a, a, random);
      stored(folder / "b.tcell", grid, other, {axis, 4, 8});
      expect_difference(folder, grid, a, other, random);
    }
  }
}

TEST_CASE("labels that keep bodies apart are compared by their materials") {
  const Grid grid = cube_grid_of(0, 1, 6);
  std::mt19937_64 random(3);
  const Named a = random_named(random, grid, {"air", "steel", "steel"});
  Named b = a;
  for (Label& l : b.cells)
    if (l != 0) l = 3 - l;  // the other body
  const TempFolder folder;
  const auto store_bodies = [&](const char* name, const std::vector<Label>& cells) {
    Metadata meta = with_tiny_chunks(metadata_of(grid, 2, 2));
    meta.labels = {{0, ""}, {1, "hull"}, {1, "deck"}};
    store_cells(folder / name, meta, cells);
  };
  store_bodies("a.tcell", a.cells);
  store_bodies("b.tcell", b.cells);
  const Difference d = find_difference(GridReader(folder / "a.tcell"), GridReader(folder / "b.tcell"), {}, kSilent);
  CHECK(d.changes.empty());
  CHECK(static_cast<uint64_t>(d.same) == 216);
}

TEST_CASE("cells are equal when all lines between them are, however they are described") {
  const TempFolder folder;
  const auto store_axes = [&](const char* name, const Axis& x, const std::string& units = "m") {
    Metadata meta;
    meta.grid.axis = {x, Axis::uniform(0, 1, 0, 1, 0.5), Axis::uniform(0, 1, 0, 1, 0.5)};
    meta.units = units;
    meta.materials = {{"air", "#00000000", 0}};
    meta.labels = {{0, ""}};
    store_cells(folder / name, meta, std::vector<Label>(static_cast<size_t>(x.cells()), 0));
  };
  store_axes("a.tcell", Axis::uniform(0, 0.5, 2, 3, 0.5));
  const auto compare = [&] { return find_difference(GridReader(folder / "a.tcell"), GridReader(folder / "b.tcell"), {}, kSilent); };
  for (const Axis& same : {Axis::uniform(1, 0.5, 0, 3, 0.25), Axis::graded({1, 1.5, 2, 2.5}, 0.5)}) {
    store_axes("b.tcell", same);
    CHECK(compare().changes.empty());
  }
  for (const auto& [other, message] : {std::pair(Axis::uniform(0, 0.5, 2, 4, 0.5), "expected 3 cells along x, found 4"),
                                       std::pair(Axis::graded({1, 1.5, 2.25, 2.5}, 0.5), "line 2 across x: expected it at 2 m, found it at 2.25 m"),
                                       std::pair(Axis::uniform(0, 0.25, 4, 6, 0.5), "line 1 across x: expected it at 1.5 m, found it at 1.25 m")}) {
    store_axes("b.tcell", other);
    CHECK_THROWS_WITH(compare(), Catch::Contains(message) && Catch::Contains("b.tcell: its cells are not those of"));
  }
  store_axes("b.tcell", Axis::uniform(0, 0.5, 2, 3, 0.5), "mm");
  CHECK_THROWS_WITH(compare(), Catch::Contains("expected the unit m, found mm"));
}

TEST_CASE("names too long for both in one are cut, and stay different") {
  const Grid grid = cube_grid_of(0, 1, 2);
  const std::string longest(250, 'n');
  const Named a{{0, 1, 0, 1, 0, 1, 0, 1}, {longest + "a", longest + "b"}}, b{{0, 0, 0, 0, 0, 0, 0, 0}, {"ä" + longest}};
  const TempFolder folder;
  stored(folder / "a.tcell", grid, a, {2, 4, 4});
  stored(folder / "b.tcell", grid, b, {2, 4, 4});
  DifferenceOptions options;
  options.output = folder / "d.tcell";
  const Difference d = find_difference(GridReader(folder / "a.tcell"), GridReader(folder / "b.tcell"), options, kSilent);
  REQUIRE(d.changes.size() == 2);
  const GridReader reader(folder / "d.tcell");
  const auto& materials = reader.meta().materials;
  CHECK((materials[1].name.size() <= kMostName && materials[1].name != materials[2].name));
  CHECK(static_cast<uint64_t>(read_stats(reader, grid.box(0))[2].cells) == 4);
}

TEST_CASE("more pairs of materials than are asked for are refused") {
  const Grid grid = cube_grid_of(0, 1, 2);
  const Named a{{0, 0, 1, 1, 0, 0, 0, 0}, {"air", "steel"}}, b{{0, 1, 0, 2, 0, 0, 0, 0}, {"air", "steel", "gold"}};
  const TempFolder folder;
  stored(folder / "a.tcell", grid, a, {2, 4, 4});
  stored(folder / "b.tcell", grid, b, {2, 4, 4});
  const GridReader x(folder / "a.tcell"), y(folder / "b.tcell");
  DifferenceOptions options;
  options.most_changes = 3;
  CHECK(find_difference(x, y, options, kSilent).changes.size() == 3);
  options.most_changes = 2;
  CHECK_THROWS_AS(find_difference(x, y, options, kSilent), InputError);
  CHECK_THROWS_WITH(find_difference(x, y, options, kSilent), Catch::StartsWith("the grids differ by more than 2 pairs of materials"));
}

TEST_CASE("when it is stopped, no file is left") {
  const Grid grid = cube_grid_of(0, 1, 20);
  std::mt19937_64 random(4);
  const Named a = random_named(random, grid, {"air", "steel"}), b = random_named(random, grid, {"air", "steel"});
  const TempFolder folder;
  for (const std::string at : {"compare", "write"})
    for (const int axis : {0, 2}) {
      stored(folder / "a.tcell", grid, a, {2, 4, 8});
      stored(folder / "b.tcell", grid, b, {axis, 4, 8});
      DifferenceOptions options;
      options.output = folder / "d.tcell";
      options.threads = 2;
      const auto stop = [&](const std::string& phase, double) {
        if (phase == at) throw Interrupted("stopped");
      };
      CHECK_THROWS_AS(find_difference(GridReader(folder / "a.tcell"), GridReader(folder / "b.tcell"), options, stop), Interrupted);
      CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 2);
    }
}

TEST_CASE("the order of the tree has each chunk of level 2 once, by its key") {
  for (const auto& [nu, nv] : {std::pair(1u, 1u), std::pair(5u, 3u), std::pair(1u, 70u), std::pair(17u, 16u)}) {
    TreeOrder order(nu, nv);
    std::optional<uint64_t> last;
    size_t count = 0;
    while (const auto place = order.next()) {
      const uint64_t key = tree_key(place->first, place->second);
      CHECK((place->first < nu && place->second < nv && (!last || *last < key)));
      last = key;
      ++count;
    }
    CHECK(count == size_t{nu} * nv);
  }
}
