// Which facets each tile of rays is given, against looking at all of them.
#include "mesher/tiles/tiling.hpp"

#include <thread>

#include "tests/mesher/tiles/tile_grids.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

std::shared_ptr<GridFacets> stored(const std::vector<Facet>& facets) {
  auto out = std::make_shared<GridFacets>();
  for (uint32_t i = 0; i < facets.size(); ++i) out->append({&facets[i], 1}, i);  // its layer is its number
  return out;
}

// The layers of the facets that every chunk of rays is given, in the order in which it gets them.
using Given = std::map<std::pair<uint32_t, uint32_t>, std::vector<uint32_t>>;  // by (cv, cu)

// Before each group is taken, other threads begin to load as many bins as may be loaded.
Given walk(Tiling& tiling) {
  Given out;
  std::vector<std::jthread> threads;
  const auto next = [&] {
    while (auto load = tiling.next_load()) threads.emplace_back(std::move(load));
    return tiling.next();
  };
  while (const auto unit = next())
    for (uint32_t row = 0; row < 4; ++row) {
      const auto lists = tiling.split(*unit, row);
      for (uint32_t u = 0; u < 4; ++u)
        for (const SceneFacet* f : lists[u]) out[{unit->cv * 4 + row, unit->cu * 4 + u}].push_back(f->layer);
    }
  return out;
}

Given given(const Metadata& meta, const std::vector<Facet>& facets, std::vector<uint8_t> widened = {}) {
  Tiling tiling(stored(facets), meta, std::move(widened));
  return walk(tiling);
}

bool overlap(uint32_t from, uint32_t to, uint32_t first, uint32_t count) { return from < to && from < first + count && first < to; }

// Each facet is given once to the chunks of which it meets a ray, and to none of which it is more than a ray away.
void expect_given(const Metadata& meta, const std::vector<Facet>& facets, const Given& lists, uint32_t wider = 0) {
  const LevelShape shape(meta, 0);
  size_t seen = 0;
  for (uint32_t cv = 0; cv < shape.chunks_v; ++cv)
    for (uint32_t cu = 0; cu < shape.chunks_u; ++cu) {
      std::vector<int> times(facets.size());
      if (const auto it = lists.find({cv, cu}); it != lists.end()) {
        for (const uint32_t i : it->second) ++times.at(i);
        ++seen;
      }
      const auto meets = [&](const RayRange& r, uint32_t by) {
        const auto from = [by](uint32_t x) { return x - std::min(x, by); };
        return overlap(from(r.u0), r.u1 + by, cu * shape.chunk_rays, shape.rays_u(cu)) &&
               overlap(from(r.v0), r.v1 + by, cv * shape.chunk_rays, shape.rays_v(cv));
      };
      for (size_t i = 0; i < facets.size(); ++i) {
        const RayRange r = exact_range(meta, facets[i]);
        REQUIRE(times[i] <= 1);
        if (meets(r, wider) && (wider > 0 || !r.empty())) REQUIRE(times[i] == 1);
        if (!meets(r, wider + 1)) REQUIRE(times[i] == 0);
      }
    }
  REQUIRE(seen == lists.size());  // none beyond the grid
}

TEST_CASE("Every tile is given each facet that may meet its rays, once, and none that is more than a ray away") {
  std::mt19937_64 random(1);
  for (const Metadata& meta : tile_grids()) {
    const std::vector<Facet> facets = facets_over(random, meta, rounds(150));
    const Given lists = given(meta, facets);
    expect_given(meta, facets, lists);
    REQUIRE(lists.size() > 0);
  }
}

Facet facet_between(double u0, double u1, double v0, double v1) { return {{Vec3{u0, v0, 1}, {u1, v0, 2}, {u0, v1, 3}}}; }

TEST_CASE("A facet that only touches a tile's last ray is handed to that tile, one that begins behind it is not") {
  // Rays at 0.5, 1.5 ... in tiles of four: the last one of the first tile is at 3.5.
  const Axis axis = Axis::uniform(0, 1, 0, 32, 0.5);
  const Metadata meta = tile_grid(2, axis, axis, axis, 4);
  const auto tiles = [&](const Facet& f) {
    std::vector<std::pair<uint32_t, uint32_t>> out;
    for (const auto& [tile, unused] : given(meta, {f})) out.push_back(tile);
    return out;
  };
  using Tiles = std::vector<std::pair<uint32_t, uint32_t>>;  // (cv, cu)
  CHECK(tiles(facet_between(3.5, 4.25, 0, 2)) == Tiles{{0, 0}});
  CHECK(tiles(facet_between(3.5, 5, 0, 2)) == Tiles{{0, 0}, {0, 1}});
  CHECK(tiles(facet_between(3.75, 5, 0, 2)) == Tiles{{0, 1}});
  CHECK(tiles(facet_between(3.5, 4, 3.5, 4)) == Tiles{{0, 0}});
  CHECK(tiles(facet_between(0, 2, 15.25, 16.25)) == Tiles{{3, 0}});
  CHECK(tiles(facet_between(0, 2, 15.25, 17)) == Tiles{{3, 0}, {4, 0}});  // over the border of a unit
}

TEST_CASE("A facet between two rays, or beside the grid, is handed to no tile") {
  const Axis axis = Axis::uniform(0, 1, 0, 32, 0.5);
  const Metadata meta = tile_grid(2, axis, axis, axis, 4);
  for (const Facet& f : {facet_between(3.6, 4.4, 0, 9), facet_between(0, 9, 7.75, 8.25), facet_between(-5, 0.25, 0, 9),
                         facet_between(31.75, 40, 0, 9), facet_between(0, 9, 32, 33)})
    CHECK(given(meta, {f}).empty());
  CHECK(given(meta, {facet_between(-1000, 1000, -1000, 1000)}).size() == 64);
}

TEST_CASE("A facet that is to be ignored is handed to no tile") {
  const Axis axis = Axis::uniform(0, 1, 0, 32, 0.5);
  const Metadata meta = tile_grid(2, axis, axis, axis, 4);
  auto store = std::make_shared<GridFacets>();
  const Facet f = facet_between(0, 9, 0, 9);
  store->append({&f, 1}, 0 | kIgnored);
  store->append({&f, 1}, 3);
  Tiling tiling(store, meta, {});
  const Given lists = walk(tiling);
  REQUIRE(lists.size() == 9);
  for (const auto& [tile, layers] : lists) CHECK(layers == std::vector<uint32_t>{3});
}

TEST_CASE("A facet of a widened body reaches a ray further on each side, within the grid") {
  std::mt19937_64 random(2);
  for (const Metadata& meta : tile_grids()) {
    const std::vector<Facet> facets = facets_over(random, meta, rounds(60));
    expect_given(meta, facets, given(meta, facets, std::vector<uint8_t>(facets.size(), 1)), 1);
  }
  const Axis axis = Axis::uniform(0, 1, 0, 32, 0.5);
  const Metadata meta = tile_grid(2, axis, axis, axis, 4);
  const std::vector<Facet> two = {facet_between(4.25, 5, 0, 2), facet_between(4.25, 5, 0, 2), facet_between(4.25, 5, 0, 2)};
  const Given lists = given(meta, two, {0, 1});  // layers 0 and 1 are of body 0, layer 2 of body 1
  CHECK(lists.at({0, 0}) == std::vector<uint32_t>{2});
  CHECK(lists.at({0, 1}) == std::vector<uint32_t>{0, 1, 2});
}

TEST_CASE("The walk takes every unit once, those of a node of the tree before any of the next one, and units without facets too") {
  std::mt19937_64 random(3);
  for (const Metadata& meta : tile_grids()) {
    Tiling tiling(stored(facets_over(random, meta, 5)), meta, {});
    const LevelShape shape(meta, 0);
    const auto units_u = (shape.chunks_u + 3) / 4, units_v = (shape.chunks_v + 3) / 4;
    std::vector<std::pair<std::vector<uint32_t>, std::pair<uint32_t, uint32_t>>> expected;  // by child, from the root down
    for (uint32_t cv = 0; cv < units_v; ++cv)
      for (uint32_t cu = 0; cu < units_u; ++cu) {
        std::vector<uint32_t> path;
        for (int level = 15; level >= 0; --level) path.push_back((cv >> (2 * level)) % 4 * 4 + (cu >> (2 * level)) % 4);
        expected.push_back({path, {cu, cv}});
      }
    std::ranges::sort(expected);
    REQUIRE(tiling.groups() == expected.size());
    for (const auto& [path, place] : expected) {
      const auto unit = tiling.next();
      REQUIRE(unit.has_value());
      REQUIRE(std::pair(unit->cu, unit->cv) == place);
    }
    REQUIRE_FALSE(tiling.next().has_value());
  }
}

TEST_CASE("A tile's facets come from the lowest to the highest along the rays, to a 4096th of the grid") {
  std::mt19937_64 random(4);
  for (const Metadata& meta : tile_grids()) {
    const std::vector<Facet> facets = facets_over(random, meta, rounds(150));
    const Axis& w = meta.grid.axis[meta.ray_axis];
    for (const auto& [tile, layers] : given(meta, facets)) {
      double last = w.min();
      for (const uint32_t i : layers) {
        const auto& v = facets[i].vertex;
        const double lowest = std::clamp(std::min({v[0][meta.ray_axis], v[1][meta.ray_axis], v[2][meta.ray_axis]}), w.min(), w.max());
        REQUIRE(lowest >= last - (w.max() - w.min()) / 4000);
        last = std::max(last, lowest);
      }
    }
  }
}

TEST_CASE("Facets that lie in bins are handed to the tiles that facets in memory are handed to, loaded by other threads or not", "[threads]") {
  const TempFolder folder;
  std::mt19937_64 random(5);
  std::vector<Metadata> grids = tile_grids();
  grids.push_back(tile_grid(0, Axis::uniform(0, 1, 0, 70, 0.5), Axis::uniform(0, 1, 0, 20, 0.5), Axis::uniform(0, 1, 0, 9, 0.5), 16));
  for (const Metadata& meta : grids) {
    std::vector<Facet> facets = facets_over(random, meta, 1200);  // a bin takes 1024
    if (&meta == &grids.back())                                   // and here even a group has several
      for (size_t i = 0; i < 9000; ++i) {
        const Vec3 at = {random_in(random, 0, 9), random_in(random, 0, 70), random_in(random, 0, 20)};
        facets.push_back({{at, {at[0] + 1, at[1] + random_in(random, 0, 1), at[2]}, {at[0], at[1], at[2] + random_in(random, 0, 1)}}});
      }
    const uint64_t groups = Tiling(stored(facets), meta, {}).groups();
    const struct {
      int ahead;
      uint64_t passed;  // groups that are taken first and not used
      TreeRange range;
    } ways[] = {{0, 0, {}}, {3, 0, {}}, {3, groups / 3, {}}, {0, 0, {1, 3}}, {3, 0, {1, 3}}};
    for (const auto& [ahead, passed, range] : ways) {
      Tiling in_memory(stored(facets), meta, {}, range);
      for (uint64_t g = 0; g < passed; ++g) REQUIRE(in_memory.next());
      Given expected = walk(in_memory);
      auto bins = std::make_unique<FacetBins>(
          meta, 0, 0, false, Budget{1, folder.path()}, ahead > 0, [](const Facet& f, uint32_t) { return f; }, std::vector<uint8_t>{});
      FacetBins::Ready ready;
      for (uint32_t i = 0; i < facets.size(); ++i) bins->make_ready({&facets[i], 1}, i, FacetBins::kOfFile, 0, ready);
      bins->add(ready);
      bins->finish();
      BinnedCounter survey(std::vector<bool>(facets.size(), true));
      Tiling tiling(std::move(bins), &survey, ahead, meta, range);
      uint64_t taken = 0;
      if (passed > 0) tiling.pass(passed, 2, [&](uint64_t all) { taken = all; });
      CHECK(taken == passed);
      Given found = walk(tiling);
      for (Given* lists : {&expected, &found})
        for (auto& [tile, layers] : *lists) std::ranges::sort(layers);
      REQUIRE(found == expected);
    }
  }
}

}  // namespace
}  // namespace teracell::mesher
