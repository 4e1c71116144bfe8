// The engines themselves: on tiles of any size all find the same crossings, and these wind around each sample point as
// rational arithmetic says.
#include "mesher/engines/engines.hpp"
#include "mesher/engines/tree.hpp"
#include "store/base/error.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/every_way.hpp"
#include "tests/support/ties.hpp"

namespace teracell::mesher {
namespace {

using shapes::Facets;
using testing::for_seeds;
using testing::random_in;
using testing::random_int;

// Facets in three layers, as a scene has them.
class SceneFacets {
 public:
  explicit SceneFacets(const Facets& facets) {
    for (const Facet& f : facets) facets_.push_back({f, static_cast<uint32_t>(facets_.size() % 3)});
    for (const SceneFacet& f : facets_) all_.push_back(&f);
  }
  SceneFacets(const SceneFacets&) = delete;
  const std::vector<const SceneFacet*>& all() const { return all_; }
  std::unique_ptr<Engine> engine(const std::string& name, int axis) const {
    return engine_maker(name, RayFrame::along(axis), [this] { return all_; })();
  }

 private:
  std::vector<SceneFacet> facets_;
  std::vector<const SceneFacet*> all_;
};

// The rays [u0, u1) x [v0, v1) along `axis`.
Tile tile_of(const Grid& grid, int axis, int64_t u0, int64_t u1, int64_t v0, int64_t v1) {
  Tile tile{RayFrame::along(axis), {}, {}, &grid.axis[axis]};
  for (int64_t i = u0; i < u1; ++i) tile.u.push_back(grid.axis[tile.frame.u].centre(i));
  for (int64_t j = v0; j < v1; ++j) tile.v.push_back(grid.axis[tile.frame.v].centre(j));
  return tile;
}

Tile whole_tile(const Grid& grid, int axis) {
  const RayFrame f = RayFrame::along(axis);
  return tile_of(grid, axis, 0, grid.axis[f.u].cells(), 0, grid.axis[f.v].cells());
}

// The crossings of each ray, sorted; none if the engine can't cast the tile plane by plane.
std::vector<std::vector<uint64_t>> cast_planes(Engine& engine, const Tile& tile, std::span<const SceneFacet* const> facets) {
  CrossingPlanes found;
  // What an earlier tile left.
  found.reset(size_t{16} * tile.rays(), 3);
  for (int i = 0; i < 40; ++i) found.add(0, 7, 3);
  std::vector<std::vector<uint64_t>> rays;
  if (!engine.cast_planes(tile, facets, found)) return rays;
  for (uint32_t r = 0; r < tile.rays(); ++r) {
    rays.emplace_back();
    for (uint32_t k = 0; k < found.counts[r]; ++k) rays.back().push_back(found.crossing(r, k));
    std::ranges::sort(rays.back());
  }
  return rays;
}

// The crossings of each ray, sorted. Plane by plane they are the same, and as many of them are decided exactly.
std::vector<std::vector<uint64_t>> cast(Engine& engine, const Tile& tile, std::span<const SceneFacet* const> facets) {
  Crossings found{{7}, {7, 7}};  // what an earlier tile left
  const uint64_t exact_before = engine.exact_decisions();
  engine.cast(tile, facets, found);
  const uint64_t exact = engine.exact_decisions() - exact_before;
  REQUIRE(found.begin.size() == tile.rays() + 1);
  REQUIRE(found.begin.back() == found.all.size());
  std::vector<std::vector<uint64_t>> rays;
  for (uint32_t r = 0; r < tile.rays(); ++r) {
    rays.emplace_back(found.all.begin() + found.begin[r], found.all.begin() + found.begin[r + 1]);
    std::ranges::sort(rays.back());
  }
  const auto planes = cast_planes(engine, tile, facets);
  REQUIRE((planes.empty() || planes == rays));
  REQUIRE(engine.exact_decisions() - exact_before == (planes.empty() ? exact : 2 * exact));
  return rays;
}

// The winding number around every cell, C order [z][y][x], by the crossings below it.
std::vector<int> windings(const std::vector<std::vector<uint64_t>>& rays, const Grid& grid, int axis) {
  const Index3 n = grid.cells();
  const RayFrame f = RayFrame::along(axis);
  std::vector<int> winding(n[0] * n[1] * n[2]);
  for (size_t r = 0; r < rays.size(); ++r) {
    int sum = 0;
    auto next = rays[r].begin();
    Index3 cell;
    cell[f.u] = static_cast<int64_t>(r) % n[f.u];
    cell[f.v] = static_cast<int64_t>(r) / n[f.u];
    for (cell[axis] = 0; cell[axis] < n[axis]; ++cell[axis]) {
      for (; next != rays[r].end() && Crossing::cell(*next) <= cell[axis]; ++next) sum += Crossing::step(*next);
      // Entering a body a ray meets a facet that turns right in (u, v), but where u, v, w is left-handed.
      winding[(cell[2] * n[1] + cell[1]) * n[0] + cell[0]] = axis == 1 ? sum : -sum;
    }
    for (; next != rays[r].end(); ++next) sum += Crossing::step(*next);
    REQUIRE(sum == 0);
  }
  return winding;
}

void expect_exact(const Facets& facets, const Grid& grid, std::mt19937_64& random) {
  const SceneFacets scene(facets);
  const auto expected = oracle::winding_numbers(facets, grid, facets[0].vertex[0]);
  for (int axis = 0; axis < 3; ++axis) {
    const RayFrame f = RayFrame::along(axis);
    std::vector<Tile> tiles = {whole_tile(grid, axis)};
    for (int i = 0; i < 4; ++i) {
      const auto range = [&](int64_t n) {
        const int64_t from = random_int(random, 0, static_cast<int>(n) - 1);
        return std::pair{from, random_int(random, 0, 2) == 0 ? from + 1 : random_int(random, static_cast<int>(from) + 1, static_cast<int>(n))};
      };
      const auto [u0, u1] = range(grid.axis[f.u].cells());
      const auto [v0, v1] = range(grid.axis[f.v].cells());
      tiles.push_back(tile_of(grid, axis, u0, u1, v0, v1));
    }
    std::vector<std::vector<std::vector<uint64_t>>> first;
    for (const std::string& name : engine_names()) {
      INFO(name << ", rays along " << axis_name(axis));
      const auto engine = scene.engine(name, axis);
      const std::span<const SceneFacet* const> listed = engine->searches_scene() ? std::span<const SceneFacet* const>() : scene.all();
      for (const VectorUnit unit : {VectorUnit::kPlain, VectorUnit::kAvx2, VectorUnit::kAvx512}) {
        const OnVectorUnit on(unit);
        std::vector<std::vector<std::vector<uint64_t>>> found;
        for (const Tile& tile : tiles) found.push_back(cast(*engine, tile, listed));
        if (first.empty()) {
          first = found;
          REQUIRE(windings(found[0], grid, axis) == expected);
        }
        REQUIRE((found == first));
        if (name != "scan") break;  // the others have no loops for vector units
      }
    }
  }
}

// Splits a facet at the middle of an edge, and not its neighbour there: a facet without area closes the gap.
Facets with_slivers(Facets facets, std::mt19937_64& random, int count) {
  for (; count > 0; --count) {
    Facet& f = facets[random_int(random, 0, static_cast<int>(facets.size()) - 1)];
    const auto [a, b, c] = f.vertex;
    Vec3 middle;
    for (int d = 0; d < 3; ++d) middle[d] = (a[d] + b[d]) / 2;
    f = {{a, middle, c}};
    facets.push_back({{middle, b, c}});
    facets.push_back({{a, b, middle}});
  }
  return facets;
}

TEST_CASE("All engines find the same crossings, those of rational arithmetic, in scenes full of exact ties", "[engines]") {
  for_seeds(0, rounds(200), [](auto& random) {
    const int n = random_int(random, 4, 9);
    std::vector<Facets> shells;
    for (int b = random_int(random, 1, 4); b > 0; --b) shells.push_back(shapes::shell_of_ties(random, n));
    const Grid grid = shapes::grid_of_ties(random, n);
    expect_exact(with_slivers(shapes::join(shells), random, 10), grid, random);
  });
}

TEST_CASE("All engines agree with rational arithmetic on ties that miss by a rounding", "[engines]") {
  for_seeds(100, rounds(20),
            [](auto& random) { expect_exact(shapes::join(shapes::decimal_tetrahedra(random, 6)), cube_grid_of(0, 1.1 / 11, 11), random); });
}

TEST_CASE("All engines agree with rational arithmetic on needles, near-vertical facets and far from the origin", "[engines]") {
  for_seeds(200, rounds(20), [](auto& random) {
    std::vector<Facets> shells;
    for (int b = 0; b < 3; ++b) {
      shells.push_back(shapes::needle(random));
      shells.push_back(shapes::sheet(random));
    }
    const Facets facets = shapes::join(shells);
    expect_exact(facets, cube_grid_of(0, 1, 10), random);
    const double far = std::array{1e6, -3e9, 1e12}[random_int(random, 0, 2)];
    expect_exact(shapes::translate(facets, {far, far, far}), cube_grid_of(far, 0.75, 13), random);
  });
}

TEST_CASE("The engine scan casts plane by plane unless a ray has more crossings than there may be planes", "[engines]") {
  const Grid grid = cube_grid_of(0, 1, 20);
  const auto plates = [](int count) {
    std::vector<Facets> out;
    for (int i = 0; i < count; ++i) out.push_back(shapes::box({2.3, 3.4, 1 + i * 0.125}, {17.6, 9.7, 1.0625 + i * 0.125}));
    return SceneFacets(shapes::join(out));
  };
  const SceneFacets few = plates(127), many = plates(128), more = plates(160);
  const Tile tile = whole_tile(grid, 2);
  CHECK(cast_planes(*few.engine("scan", 2), tile, few.all())[5 * 20 + 5].size() == 254);
  CHECK(cast_planes(*many.engine("scan", 2), tile, many.all()).empty());
  CHECK(cast_planes(*more.engine("scan", 2), tile, more.all()).empty());
  CHECK(cast(*many.engine("scan", 2), tile, many.all())[5 * 20 + 5].size() == 256);
  // Planes of many rays have fewer places in all.
  const Tile wide = whole_tile(cube_grid_of(0, 20.0 / 256, 256), 2);
  CHECK(cast_planes(*few.engine("scan", 2), wide, few.all()).empty());
}

TEST_CASE("Of thousands of facets, small or large compared with a row of rays, every vector unit finds the crossings that a search finds",
          "[engines]") {
  // Vertices on a lattice that rays and sample points share: some facets of each block are decided exactly.
  const Facets fine = shapes::sphere({5, 5, 5}, 4, 5, 0.125), coarse = shapes::sphere({5, 5, 5}, 4.5, 0, 0.125);
  const SceneFacets scene(shapes::join({fine, coarse, shapes::box({1, 2, 3}, {9, 8, 7})}));
  for (const int64_t cells : {40, 80, 320})
    for (int axis = 0; axis < 3; ++axis) {
      const Grid grid = cube_grid(0, 10, cells);
      const RayFrame f = RayFrame::along(axis);
      const Tile tile = tile_of(grid, axis, 0, grid.axis[f.u].cells(), cells / 3, std::min(cells, cells / 3 + 40));
      const auto expected = cast(*scene.engine("tree", axis), tile, {});
      for (const VectorUnit unit : {VectorUnit::kPlain, VectorUnit::kAvx2, VectorUnit::kAvx512}) {
        const OnVectorUnit on(unit);
        REQUIRE((cast(*scene.engine("scan", axis), tile, scene.all()) == expected));
      }
    }
}

TEST_CASE("Without facets every engine finds no crossing", "[engines]") {
  const SceneFacets scene({});
  const Grid grid = cube_grid_of(0, 1, 3);
  for (const std::string& name : engine_names()) {
    INFO(name);
    const auto engine = scene.engine(name, 2);
    for (const auto& ray : cast(*engine, whole_tile(grid, 2), scene.all())) REQUIRE(ray.empty());
  }
}

TEST_CASE("Boxes that are equal, a rounding apart or ever smaller lie in the tree as any others", "[engines]") {
  std::mt19937_64 random(1);
  std::vector<Facets> shells(300, shapes::box({1, 1, 1}, {3, 4, 5}));
  for (double edge = 1; edge < 1 + 0x1p-46; edge = std::nextafter(edge, 2)) shells.push_back(shapes::box({edge, 1, edge}, {3, 1 + edge, 5}));
  for (int i = 0; i < 60; ++i) shells.push_back(shapes::box({2, 2, 2}, {2 + std::ldexp(1.0, -i / 2), 2 + std::ldexp(1.0, -i / 3), 3}));
  expect_exact(shapes::join(shells), cube_grid_of(0, 0.5, 12), random);
}

TEST_CASE("A search of the tree finds every facet whose box holds the ray and looks at few others", "[engines]") {
  const SceneFacets scene(shapes::sphere({0, 0, 0}, 1, 5));  // 8192 facets
  const FacetTree tree(scene.all(), RayFrame::along(2));
  std::mt19937_64 random(5);
  size_t looked_at = 0;
  for (int i = 0; i < 500; ++i) {
    const double u = random_in(random, -1, 1), v = random_in(random, -1, 1);
    std::vector<const SceneFacet*> found;
    tree.search(u, v, [&](const SceneFacet& facet) { found.push_back(&facet); });
    looked_at += found.size();
    std::ranges::sort(found);
    REQUIRE(std::ranges::adjacent_find(found) == found.end());
    for (const SceneFacet* facet : scene.all()) {
      const auto& [a, b, c] = facet->facet.vertex;
      const bool holds = std::min({a[0], b[0], c[0]}) <= u && u <= std::max({a[0], b[0], c[0]}) && std::min({a[1], b[1], c[1]}) <= v &&
                         v <= std::max({a[1], b[1], c[1]});
      if (holds) REQUIRE(std::ranges::binary_search(found, facet));
    }
  }
  REQUIRE(looked_at < 500 * 30);
}

TEST_CASE("Engines of one maker share its tree between threads and outlive the maker", "[engines][threads]") {
  const SceneFacets scene(shapes::sphere({5, 5, 5}, 4, 4, 0.125));
  const Grid grid = cube_grid_of(0, 0.25, 40);
  const Tile tile = whole_tile(grid, 2);
  const auto expected = cast(*scene.engine("scan", 2), tile, scene.all());
  for (const std::string& name : engine_names()) {
    if (name == "brute") continue;  // slow, and shares no more than the tree does
    INFO(name);
    std::vector<std::unique_ptr<Engine>> engines;
    {
      const EngineMaker make = engine_maker(name, RayFrame::along(2), [&] { return scene.all(); });
      for (int i = 0; i < 3; ++i) engines.push_back(make());
    }
    std::vector<Crossings> found(engines.size());
    std::vector<std::thread> threads;
    for (size_t i = 0; i < engines.size(); ++i) threads.emplace_back([&, i] { engines[i]->cast(tile, scene.all(), found[i]); });
    for (std::thread& thread : threads) thread.join();
    for (Crossings& f : found) {
      REQUIRE(f.begin.size() == expected.size() + 1);
      for (size_t r = 0; r < expected.size(); ++r) {
        std::sort(f.all.begin() + f.begin[r], f.all.begin() + f.begin[r + 1]);
        REQUIRE(std::equal(expected[r].begin(), expected[r].end(), f.all.begin() + f.begin[r], f.all.begin() + f.begin[r + 1]));
      }
    }
  }
}

TEST_CASE("An engine of another name is refused and the known ones are named", "[engines]") {
  REQUIRE_THROWS_WITH(engine_maker("magic", RayFrame::along(0), {}), Catch::Contains("'magic'") && Catch::Contains("scan, slice, tree, brute"));
  REQUIRE(engine_names().front() == "scan");
}

TEST_CASE("More crossings than a tile may hold are refused by their number", "[engines]") {
  const Grid grid = cube_grid_of(0, 1, 3);
  REQUIRE_NOTHROW(check_crossings(whole_tile(grid, 0), uint64_t{1} << 28));
  REQUIRE_THROWS_WITH(check_crossings(whole_tile(grid, 0), (uint64_t{1} << 28) + 1), Catch::Contains("3 x 3 rays") && Catch::Contains("268435457"));
}

}  // namespace
}  // namespace teracell::mesher
