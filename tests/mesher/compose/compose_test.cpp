// Crossings of a tile of rays -> runs, against every cell looked at alone.
#include "mesher/compose/compose.hpp"

#include "store/base/error.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

// The bodies of a scene, and the layers of their surfaces.
struct SomeBodies {
  std::vector<Layer> layers;
  std::vector<uint32_t> rank;
  std::vector<Label> label, in_others;  // none: the same
  Composer composer() const { return {layers, rank, label, in_others.empty() ? label : in_others, 2}; }
};

// A tile of one row of rays, each a list of crossings.
using Rays = std::vector<std::vector<uint64_t>>;

Crossings as_tile(const Rays& rays) {
  Crossings out;
  out.begin = {0};
  for (const auto& ray : rays) {
    out.all.insert(out.all.end(), ray.begin(), ray.end());
    out.begin.push_back(static_cast<uint32_t>(out.all.size()));
  }
  return out;
}

uint64_t up(uint32_t cell, uint32_t layer) { return Crossing::pack(cell, layer, true); }
uint64_t down(uint32_t cell, uint32_t layer) { return Crossing::pack(cell, layer, false); }

RayBlock composed(Composer& composer, const Rays& rays, uint32_t length) {
  Crossings crossings = as_tile(rays);
  RayBlock out;
  composer.compose(crossings, static_cast<uint32_t>(rays.size()), 1, length, out);
  return out;
}

std::vector<Overlap> unpacked(const Bytes& packed) {
  std::vector<Overlap> out;
  OverlapUnpacker unpacker(packed);
  while (const auto overlap = unpacker.next()) out.push_back(*overlap);
  return out;
}

// The labels of a ray's cells.
std::vector<Label> cells_of(const RayBlock& block, uint32_t ray) {
  std::vector<Label> out;
  block.for_each_run(ray, [&](uint32_t from, uint32_t to, SetId label) {
    REQUIRE((from < to || block.length == 0));
    REQUIRE((out.empty() || out.back() != label));  // neighbouring runs differ
    out.insert(out.end(), to - from, label);
  });
  return out;
}

std::vector<Label> one_ray(const SomeBodies& bodies, const std::vector<uint64_t>& crossings, uint32_t length) {
  Composer composer = bodies.composer();
  return cells_of(composed(composer, {crossings}, length), 0);
}

// The bodies that hold a cell: of each layer the crossings up to it are counted.
std::vector<bool> holders(const SomeBodies& bodies, const std::vector<uint64_t>& crossings, uint32_t cell) {
  std::vector<int> winding(bodies.layers.size()), count(bodies.layers.size());
  for (const uint64_t c : crossings)
    if (Crossing::cell(c) <= cell) winding[Crossing::layer(c)] += Crossing::step(c), ++count[Crossing::layer(c)];
  std::vector<bool> out(bodies.label.size());
  for (size_t l = 0; l < bodies.layers.size(); ++l)
    if (bodies.layers[l].evenodd ? count[l] % 2 != 0 : winding[l] != 0) out[bodies.layers[l].body] = true;
  return out;
}

std::optional<uint32_t> strongest(const SomeBodies& bodies, const std::vector<bool>& holds) {
  std::optional<uint32_t> out;
  for (uint32_t b = 0; b < holds.size(); ++b)
    if (holds[b] && (!out || bodies.rank[b] < bodies.rank[*out])) out = b;
  return out;
}

// Two bodies, the second one stronger; each has a layer by winding and one by parity, numbered as in a scene.
const SomeBodies kTwo = {{{0, false}, {0, true}, {1, false}, {1, true}}, {1, 0}, {7, 9}};

TEST_CASE("A body owns the cells from the crossing into it up to the one out of it") {
  CHECK(one_ray(kTwo, {up(2, 0), down(5, 0)}, 7) == std::vector<Label>{0, 0, 7, 7, 7, 0, 0});
  CHECK(one_ray(kTwo, {}, 3) == std::vector<Label>{0, 0, 0});
  CHECK(one_ray(kTwo, {down(5, 0), up(2, 0)}, 7) == std::vector<Label>{0, 0, 7, 7, 7, 0, 0});  // crossings come in any order
}

TEST_CASE("A body that begins below the ray's first cell or ends above its last one owns the cells at its ends") {
  CHECK(one_ray(kTwo, {up(0, 0), down(2, 0)}, 4) == std::vector<Label>{7, 7, 0, 0});
  CHECK(one_ray(kTwo, {up(3, 0), down(4, 0)}, 4) == std::vector<Label>{0, 0, 0, 7});
  CHECK(one_ray(kTwo, {up(0, 0), down(4, 0)}, 4) == std::vector<Label>{7, 7, 7, 7});
  CHECK(one_ray(kTwo, {up(4, 0), down(4, 0)}, 4) == std::vector<Label>{0, 0, 0, 0});
  CHECK(one_ray(kTwo, {up(0, 0), down(0, 0)}, 4) == std::vector<Label>{0, 0, 0, 0});
}

TEST_CASE("Nonzero holds where a surface winds twice and inside out, evenodd does not hold where it is crossed twice") {
  const std::vector<uint64_t> winding = {up(1, 0), up(2, 0), down(4, 0), down(5, 0)}, parity = {up(1, 1), up(2, 1), down(4, 1), down(5, 1)};
  CHECK(one_ray(kTwo, winding, 6) == std::vector<Label>{0, 7, 7, 7, 7, 0});
  CHECK(one_ray(kTwo, parity, 6) == std::vector<Label>{0, 7, 0, 0, 7, 0});
  CHECK(one_ray(kTwo, {down(1, 0), up(4, 0)}, 6) == std::vector<Label>{0, 7, 7, 7, 0, 0});
  CHECK(one_ray(kTwo, {down(1, 1), down(4, 1)}, 6) == std::vector<Label>{0, 7, 7, 7, 0, 0});  // of parity the direction says nothing
}

TEST_CASE("A body of both rules is where either of them holds") {
  CHECK(one_ray(kTwo, {up(1, 0), down(4, 0), up(3, 1), up(6, 1)}, 8) == std::vector<Label>{0, 7, 7, 7, 7, 7, 0, 0});
  CHECK(one_ray(kTwo, {up(1, 0), down(3, 0), up(3, 1), up(6, 1)}, 8) == std::vector<Label>{0, 7, 7, 7, 7, 7, 0, 0});
}

TEST_CASE("Where bodies overlap the strongest owns the cells, whatever its number") {
  const std::vector<uint64_t> both = {up(1, 0), down(5, 0), up(3, 2), down(7, 2)};
  CHECK(one_ray(kTwo, both, 8) == std::vector<Label>{0, 7, 7, 9, 9, 9, 9, 0});
  SomeBodies first_stronger = kTwo;
  std::swap(first_stronger.rank[0], first_stronger.rank[1]);
  CHECK(one_ray(first_stronger, both, 8) == std::vector<Label>{0, 7, 7, 7, 7, 9, 9, 0});
}

TEST_CASE("Bodies of one label make one run, and a body of the background's label cuts a hole") {
  SomeBodies same = kTwo;
  same.label = {7, 7};
  CHECK(one_ray(same, {up(1, 0), down(5, 0), up(3, 2), down(7, 2)}, 8) == std::vector<Label>{0, 7, 7, 7, 7, 7, 7, 0});
  SomeBodies hole = kTwo;
  hole.label = {7, 0};
  CHECK(one_ray(hole, {up(1, 0), down(7, 0), up(3, 2), down(5, 2)}, 8) == std::vector<Label>{0, 7, 7, 0, 0, 7, 7, 0});
  CHECK(one_ray(hole, {up(3, 2), down(5, 2)}, 8) == std::vector<Label>(8, 0));
}

TEST_CASE("A counter that the end of its ray leaves open is an error that says which ray") {
  for (const std::vector<uint64_t>& open :
       {std::vector{up(1, 0)}, {up(1, 0), up(3, 0)}, {up(2, 1)}, {up(1, 0), down(2, 0), up(1, 2)}, {down(9, 0)}, {up(1, 0), up(1, 2), down(4, 2)}}) {
    Composer composer = kTwo.composer();
    CHECK_THROWS_WITH(composed(composer, {{}, open}, 6), Catch::Contains("ray 1, 0") && Catch::Contains("1 of its surfaces"));
  }
  Composer composer = kTwo.composer();
  CHECK_THROWS_WITH(composed(composer, {{up(1, 0), up(1, 2)}}, 6), Catch::Contains("2 of its surfaces"));
}

TEST_CASE("A mark is a stretch of its body's, but no crossing that lies close to another one") {
  const auto mark = [](uint64_t c) { return c | Crossing::kMark; };
  Composer composer = kTwo.composer();
  const RayBlock out = composed(
      composer, {{up(1, 0), down(5, 0), mark(up(2, 2)), mark(down(3, 2)), mark(up(4, 0)), mark(down(6, 0))}, {mark(up(2, 0)), mark(down(2, 0))}}, 8);
  CHECK(cells_of(out, 0) == std::vector<Label>{0, 7, 9, 7, 7, 7, 0, 0});
  CHECK(composer.crossing_pairs().empty());
  CHECK(composer.take_overlaps({{0, 0, 0}, {2, 1, 8}}).empty());
}

TEST_CASE("Bodies overlap where both are inside, before, between and behind cells that are only marked") {
  const auto mark = [](uint64_t c) { return c | Crossing::kMark; };
  Composer composer = kTwo.composer();
  composed(composer,
           {{up(1, 0), down(9, 0), mark(up(2, 2)), mark(down(3, 2)), up(3, 2), down(5, 2), mark(up(5, 2)), mark(down(7, 2)), mark(up(6, 2)),
             mark(down(8, 2))}},
           9);
  const std::vector<Overlap> found = unpacked(composer.take_overlaps({{10, 20, 30}, {11, 21, 39}}));
  REQUIRE(found.size() == 1);
  CHECK(found[0] == Overlap{{0, 1}, false, 2, {{10, 20, 33}, {11, 21, 35}}, {10, 20, 33}});
}

TEST_CASE("Close crossings are pairs of one body between the same two sample points, not beyond the ends of the ray") {
  Composer composer = kTwo.composer();
  composed(composer,
           {{up(2, 0), down(2, 0)},                                              // a pair
            {up(0, 0), down(0, 0), up(5, 0), down(5, 0)},                        // below the first sample point, above the last one
            {up(3, 0), up(3, 2), down(4, 0), down(4, 2)},                        // of two bodies each
            {up(1, 0), down(1, 0), up(1, 1), up(1, 1), up(1, 1), down(2, 1)},    // five of one body, in two layers
            {up(2, 2), down(2, 2), up(2, 0), down(2, 0), up(4, 2), down(4, 2)}},
           5);
  struct Expected {
    uint32_t ray, cell, body;
    uint64_t pairs;
  };
  const std::vector<Expected> expected = {{0, 2, 0, 1}, {3, 1, 0, 2}, {4, 2, 0, 1}, {4, 2, 1, 1}, {4, 4, 1, 1}};
  REQUIRE(composer.crossing_pairs().size() == expected.size());
  for (size_t i = 0; i < expected.size(); ++i) {
    const CrossingPairs& c = composer.crossing_pairs()[i];
    CHECK((c.ray == expected[i].ray && c.cell == expected[i].cell && c.body == expected[i].body && c.pairs == expected[i].pairs));
  }
  composed(composer, {{}}, 5);
  CHECK(composer.crossing_pairs().empty());
}

// Crossings of some of the layers, closed by their rules.
std::vector<uint64_t> random_ray(std::mt19937_64& random, const SomeBodies& bodies, uint32_t length) {
  std::vector<uint64_t> out;
  const int kind = random_int(random, 0, 9);  // empty, one layer, several; sometimes more than are sorted by insertion
  const int most = kind == 0 ? 0 : kind < 4 ? 1 : kind < 9 ? 6 : 60;
  const auto layers = static_cast<int>(bodies.layers.size());
  const auto only = static_cast<uint32_t>(random_int(random, 0, layers - 1));
  for (int i = most; i > 0; --i) {
    const auto layer = kind < 4 ? only : static_cast<uint32_t>(random_int(random, 0, layers - 1));
    const auto cell = [&] { return static_cast<uint32_t>(random_int(random, 0, static_cast<int>(length) + 1)); };
    const bool first_up = random_int(random, 0, 1) == 0;
    out.push_back(Crossing::pack(cell(), layer, first_up));
    out.push_back(Crossing::pack(cell(), layer, bodies.layers[layer].evenodd ? random_int(random, 0, 1) == 0 : !first_up));
  }
  std::ranges::shuffle(out, random);
  return out;
}

// Of the first layer, between the first and the last cell if there are enough; rarely anywhere, and perhaps empty.
std::vector<uint64_t> pair_of(std::mt19937_64& random, uint32_t length) {
  const auto end = static_cast<int>(length);
  const int least = random_int(random, 0, 40) > 0 ? 1 : 0;
  const int first = random_int(random, least, std::max(least, end - 2));
  return {up(static_cast<uint32_t>(first), 0), down(static_cast<uint32_t>(random_int(random, first + least, std::max(first + 1, end - least))), 0)};
}

// The same crossings in the same order, in other cells: those of one cell in one cell or, now and then, all in different ones; perhaps from the first
// cell on, and up to the end. REQUIRES: they are fewer than `length`.
std::vector<uint64_t> like(std::mt19937_64& random, std::vector<uint64_t> ray, uint32_t length) {
  std::ranges::sort(ray);
  std::vector<uint32_t> cells(length - 1);
  std::iota(cells.begin(), cells.end(), 1);
  std::ranges::shuffle(cells, random);
  cells.resize(ray.size());
  std::ranges::sort(cells);
  const bool at_first = random_int(random, 0, 2) == 0, at_end = random_int(random, 0, 2) == 0;
  const bool apart = random_int(random, 0, 4) == 0;
  std::vector<uint64_t> out;
  for (size_t i = 0, group = 0; i < ray.size(); ++i) {
    group += i > 0 && Crossing::cell(ray[i]) != Crossing::cell(ray[i - 1]);
    out.push_back(uint64_t{cells[apart ? i : group]} << 32 | static_cast<uint32_t>(ray[i]));
  }
  const auto move_to = [&](uint32_t from, uint32_t to) {
    for (uint64_t& c : out)
      if (Crossing::cell(c) == from) c = uint64_t{to} << 32 | static_cast<uint32_t>(c);
  };
  if (at_first && !out.empty()) move_to(Crossing::cell(out.front()), 0);
  if (at_end && !out.empty()) move_to(Crossing::cell(out.back()), length);
  std::ranges::shuffle(out, random);
  return out;
}

TEST_CASE("Cells, what bodies own and cover, and where they overlap, are those of looking at every cell alone, tile after tile") {
  std::mt19937_64 random(1);
  for (size_t scene = 0; scene < rounds(40); ++scene) {
    SomeBodies bodies;
    const int count = random_int(random, 1, 5);
    for (int b = 0; b < count; ++b) {
      bodies.rank.push_back(static_cast<uint32_t>(b));
      bodies.label.push_back(static_cast<Label>(random_int(random, 0, 3)));
      bodies.in_others.push_back(scene % 2 == 0 ? bodies.label.back() : static_cast<Label>(random_int(random, 0, 5)));
      for (const bool evenodd : {false, true}) bodies.layers.push_back({static_cast<uint32_t>(b), evenodd});
    }
    std::ranges::shuffle(bodies.rank, random);
    Composer composer = bodies.composer();
    std::vector<uint64_t> before;  // a ray of this tile or of one before, whose course is known
    for (int tile = 0; tile < 6; ++tile) {  // of a composer that has made others
      const auto length = static_cast<uint32_t>(random_int(random, 1, 30));
      const bool pairs = tile % 2 == 1;  // nearly all rays go into and out of one body, as they mostly do, and many are composed at once
      const uint32_t nu = pairs ? 41 : 5, nv = 3;
      const Box tile_cells{{100, 200, 0}, {100 + nu, 203, length}};
      Rays rays;
      while (rays.size() < nu * nv) {
        const bool again = !pairs && before.size() < length && random_int(random, 0, 2) > 0;
        rays.push_back(pairs && random_int(random, 0, 30) > 0 ? pair_of(random, length)
                       : again                                ? like(random, before, length)
                                                              : random_ray(random, bodies, length));
        if (!pairs) before = rays.back();
      }
      Crossings crossings = as_tile(rays);
      RayBlock out;
      composer.compose(crossings, nu, nv, length, out);
      REQUIRE((out.nu == nu && out.nv == nv && out.length == length));
      using Pairs = std::map<std::array<uint32_t, 3>, uint64_t>;  // by ray, cell and body
      Pairs close, expected_close;
      for (const CrossingPairs& p : composer.crossing_pairs()) close[{p.ray, p.cell, p.body}] += p.pairs;
      for (uint32_t ray = 0; ray < rays.size(); ++ray)
        for (const uint64_t c : rays[ray])
          if (!Crossing::is_mark(c) && Crossing::cell(c) > 0 && Crossing::cell(c) < length)
            ++expected_close[{ray, Crossing::cell(c), bodies.layers[Crossing::layer(c)].body}];
      for (auto& [place, crossings_there] : expected_close) crossings_there /= 2;
      std::erase_if(expected_close, [](const auto& item) { return item.second == 0; });
      REQUIRE(close == expected_close);
      std::map<std::array<uint32_t, 2>, Overlap> overlaps;
      std::map<uint32_t, std::pair<uint64_t, uint64_t>> cells, found;  // of a body: owned, covered
      for (uint32_t ray = 0; ray < out.rays(); ++ray) {
        std::vector<Label> expected;
        for (uint32_t cell = 0; cell < length; ++cell) {
          const std::vector<bool> holds = holders(bodies, rays[ray], cell);
          const auto owner = strongest(bodies, holds);
          const bool overlap = std::ranges::count(holds, true) > 1;
          expected.push_back(owner ? (overlap ? bodies.in_others : bodies.label)[*owner] : 0);
          for (uint32_t b = 0; b < holds.size(); ++b)
            if (holds[b]) ++(b == *owner ? cells[b].first : cells[b].second);
          for (uint32_t b = 0; b < holds.size(); ++b)
            for (uint32_t a = 0; a < b; ++a) {
              if (!holds[a] || !holds[b]) continue;
              const Index3 at{tile_cells.lo[0] + ray % nu, tile_cells.lo[1] + ray / nu, tile_cells.lo[2] + cell};
              const Overlap here{{a, b}, *owner != a && *owner != b, 1, {at, {at[0] + 1, at[1] + 1, at[2] + 1}}, at};
              if (const auto [pair, is_new] = overlaps.try_emplace({a, b}, here); !is_new) pair->second.add(here);
            }
        }
        REQUIRE(cells_of(out, ray) == expected);
      }
      std::vector<Overlap> expected_overlaps;
      for (const auto& [bodies_of, overlap] : overlaps) expected_overlaps.push_back(overlap);
      REQUIRE(unpacked(composer.take_overlaps(tile_cells)) == expected_overlaps);
      for (const BodyCells& b : composer.take_cells()) {
        REQUIRE(found.try_emplace(b.body, b.owned, b.covered).second);
        if (b.owned == 0 && b.covered == 0) found.erase(b.body);  // its surface was met beyond the cells
      }
      REQUIRE(found == cells);
    }
  }
}

TEST_CASE("Rays in which bodies are nested find how much each pair has in common, however many there are") {
  for (const uint32_t count : {3u, 23u, 24u, 200u}) {  // the last two are too many for a course
    SomeBodies bodies;
    const uint32_t length = 2 * count + 2;
    std::vector<uint64_t> ray;
    for (uint32_t b = 0; b < count; ++b) {  // each in the one before, and stronger
      bodies.rank.push_back(count - b);
      bodies.label.push_back(1), bodies.in_others.push_back(1);
      for (const bool evenodd : {false, true}) bodies.layers.push_back({b, evenodd});
      ray.push_back(up(1 + b, 2 * b)), ray.push_back(down(length - 1 - b, 2 * b));
    }
    Composer composer = bodies.composer();
    for (int tile = 0; tile < 2; ++tile) {
      Crossings crossings = as_tile({ray, ray, ray, ray});
      RayBlock out;
      composer.compose(crossings, 2, 2, length, out);
      const std::vector<Overlap> found = unpacked(composer.take_overlaps({{0, 0, 0}, {2, 2, length}}));
      REQUIRE(found.size() == count * (count - 1) / 2);
      for (const Overlap& o : found) {
        REQUIRE(o.cells == 4 * 2 * (count - o.bodies[1]));
        REQUIRE((o.box.lo == Index3{0, 0, 1 + o.bodies[1]} && o.box.hi == Index3{2, 2, length - 1 - o.bodies[1]}));
        REQUIRE(o.third == (o.bodies[1] + 1 < count));
      }
    }
    const auto cells = composer.take_cells();
    REQUIRE(cells.size() == count);
    for (const BodyCells& b : cells) REQUIRE((b.owned == 8 * 2 && b.covered == 8 * 2 * (count - 1 - b.body)));
  }
}

TEST_CASE("Cells are counted anew after they were taken") {
  Composer composer = kTwo.composer();
  composed(composer, {{up(1, 0), down(5, 0), up(3, 2), down(4, 2)}, {up(0, 0), down(6, 0)}}, 6);
  composed(composer, {{up(1, 0), down(2, 0)}}, 6);
  const auto cells = composer.take_cells();
  REQUIRE(cells.size() == 2);
  for (const BodyCells& b : cells) {
    CHECK(b.owned == (b.body == 0 ? 3 + 6 + 1 : 1));
    CHECK(b.covered == (b.body == 0 ? 1 : 0));
  }
  CHECK(composer.take_cells().empty());
  composed(composer, {{up(1, 2), down(3, 2)}}, 6);
  REQUIRE(composer.take_cells().at(0).owned == 2);
}

}  // namespace
}  // namespace teracell::mesher
