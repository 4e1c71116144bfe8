// The cells themselves: meshed scenes against rational arithmetic, analytic solids and each other.
#include <catch2/catch.hpp>

#include <fmt/format.h>

#include "tests/support/meshed.hpp"
#include "tests/support/sanitized.hpp"

namespace teracell {
namespace {

using namespace testing;
using oracle::Body;
using oracle::Rule;

Grid uniform_grid(double min, double step, int64_t nx, int64_t ny, int64_t nz) {
  return {{Axis::uniform(min, step, 0, nx, 0.5), Axis::uniform(min, step, 0, ny, 0.5), Axis::uniform(min, step, 0, nz, 0.5)}};
}

// Meshes along x, y and z; each must give exactly what rational arithmetic gives.
void expect_exact(const std::vector<Body>& bodies, const Grid& grid) {
  const TempFolder folder;
  const Scene scene = scene_of(folder, bodies, grid);
  const std::vector<uint32_t> expected = oracle::materials(bodies, grid);
  for (int axis = 0; axis < 3; ++axis) {
    MeshOptions options;
    options.axis = axis;
    options.threads = 1;
    mesh_quietly(scene, folder / "g.tcell", options);
    const GridReader reader(folder / "g.tcell");
    REQUIRE(reader.meta().grid == grid);
    const std::vector<uint32_t> found = all_cells(reader);
    size_t differ = 0;
    for (size_t i = 0; i < found.size(); ++i) differ += found[i] != expected[i];
    INFO("rays along " << axis_name(axis) << ", " << found.size() << " cells");
    REQUIRE(differ == 0);
  }
}

double random_in(std::mt19937_64& random, double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(random); }
int random_int(std::mt19937_64& random, int lo, int hi) { return std::uniform_int_distribution<int>(lo, hi)(random); }

// A box whose corners are multiples of half a cell: half of its faces lie on cell centres.
shapes::Facets lattice_box(std::mt19937_64& random, int n) {
  Vec3 lo, hi;
  for (int d = 0; d < 3; ++d) {
    lo[d] = random_int(random, -1, 2 * n - 2) / 2.0;
    hi[d] = lo[d] + random_int(random, 1, n) / 2.0;
  }
  return shapes::box(lo, hi);
}

TEST_CASE("A box owns its lower faces and not its upper ones, whatever the ray axis") {
  const Grid grid = uniform_grid(0, 1, 6, 6, 6);
  const std::vector<Body> bodies = {{shapes::box({1.5, 1.5, 1.5}, {3.5, 3.5, 3.5})}};
  expect_exact(bodies, grid);
  const auto cells = oracle::materials(bodies, grid);
  REQUIRE(cells[(1 * 6 + 1) * 6 + 1] == 1);
  REQUIRE(cells[(3 * 6 + 3) * 6 + 3] == 0);
}

TEST_CASE("Six tetrahedra around a diagonal fill their box: every ray meets edges and vertices, none leaks") {
  std::vector<Body> bodies;
  uint32_t material = 1;
  for (const auto& t : shapes::box_in_tetrahedra({0.5, 0.5, 0.5}, {8.5, 8.5, 8.5})) bodies.push_back({t, Rule::kNonzero, material++});
  expect_exact(bodies, uniform_grid(0, 1, 9, 9, 9));
  expect_exact(bodies, uniform_grid(0, 0.5, 18, 18, 18));
}

TEST_CASE("Random scenes full of exact ties equal rational arithmetic along every axis") {
  for (uint64_t seed = 0; seed < rounds(40); ++seed) {
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    const int n = random_int(random, 5, 11);
    std::vector<Body> bodies;
    for (int b = random_int(random, 1, 5); b > 0; --b) {
      Body body;
      switch (random_int(random, 0, 5)) {
        case 0: body.facets = lattice_box(random, n); break;
        case 1: body.facets = shapes::join({lattice_box(random, n), lattice_box(random, n)}); break;  // overlapping shells
        case 2: body.facets = shapes::sphere({n / 2.0, n / 2.0, n / 2.0}, random_in(random, 1, n / 2.0), 1, 0.5); break;
        case 3: body.facets = shapes::join(shapes::random_tetrahedra(random, 3, -1, n + 1, 0.5)); break;
        case 4: body.facets = shapes::torus({n / 2.0, n / 2.0, n / 2.0}, n / 3.0, n / 8.0, 7, 5, 0.25); break;
        default: body.facets = shapes::l_shape({0.5, 1.5, 0.5}, n - 2, 1 + (n > 6), n - 3); break;
      }
      if (random_int(random, 0, 3) == 0) body.facets = shapes::flip(body.facets);
      if (random_int(random, 0, 2) == 0) body.rule = Rule::kEvenodd;
      body.material = static_cast<uint32_t>(random_int(random, 1, 3));
      body.priority = random_int(random, 0, 2);
      bodies.push_back(std::move(body));
    }
    Grid grid;
    for (Axis& axis : grid.axis) {
      const double sample = std::array{0.5, 0.0, 0.25}[random_int(random, 0, 2)];
      if (random_int(random, 0, 2) == 0) {  // graded, planes on the same lattice
        std::vector<double> planes = {-1};
        while (planes.back() < n + 1) planes.push_back(planes.back() + random_int(random, 1, 6) / 4.0);
        axis = Axis::graded(planes, sample);
      } else {
        const double step = std::array{1.0, 0.5, 0.75}[random_int(random, 0, 2)];
        const auto cells = static_cast<int64_t>((n + 1) / step);
        axis = Axis::uniform(-0.5, step, 0, cells, sample);
      }
    }
    expect_exact(bodies, grid);
  }
}

TEST_CASE("Decimal lattices, whose ties miss by a rounding, equal rational arithmetic") {
  for (uint64_t seed = 100; seed < 112; ++seed) {
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    std::vector<Body> bodies;
    for (int b = 0; b < 3; ++b) {
      auto facets = shapes::join(shapes::random_tetrahedra(random, 2, 0, 10, 1));
      for (Facet& f : facets)
        for (Vec3& p : f.vertex)
          for (double& x : p) x = x / 10 + 0.05;  // 0.15, 0.25 ...: not representable
      bodies.push_back({facets, Rule::kNonzero, static_cast<uint32_t>(b + 1)});
    }
    Scene scene;
    Grid grid{{Axis::uniform(0, 1.1 / 11, 0, 11, 0.5), Axis::uniform(0, 1.1 / 11, 0, 11, 0.5), Axis::uniform(0, 1.1 / 11, 0, 11, 0.5)}};
    expect_exact(bodies, grid);
  }
}

TEST_CASE("Needles and near-vertical facets, where doubles lose the slope, equal rational arithmetic") {
  for (uint64_t seed = 200; seed < 212; ++seed) {
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    std::vector<Body> bodies;
    for (int b = 0; b < 4; ++b) {
      const double tiny = std::ldexp(1.0, -random_int(random, 20, 50));
      const Vec3 p = {random_in(random, 0, 9), random_in(random, 0, 9), random_in(random, 0, 9)};
      Vec3 q = p, r = p, s = p;
      q[random_int(random, 0, 2)] += 9;
      r = q;
      r[random_int(random, 0, 2)] += tiny;
      s[random_int(random, 0, 2)] -= 7;
      bodies.push_back({shapes::tetrahedron(p, q, r, s), Rule::kNonzero, static_cast<uint32_t>(b + 1)});
      bodies.push_back({shapes::tetrahedron({0.5, 0.5, 0.5}, {9.5, 9.5, 0.5 + tiny}, {9.5, 9.5, 9.5}, {9.5 + tiny, 9.5, 0.5}), Rule::kNonzero, 5});
    }
    expect_exact(bodies, uniform_grid(0, 1, 10, 10, 10));
  }
}

TEST_CASE("A grid that cuts through a body, or lies wholly inside it, is the window of the larger grid") {
  const std::vector<Body> bodies = {{shapes::sphere({5, 5, 5}, 4, 2, 0.5)}, {shapes::box({-20, -20, -20}, {20, 20, 5}), Rule::kNonzero, 2, -1}};
  expect_exact(bodies, uniform_grid(3, 0.5, 7, 9, 5));
  expect_exact(bodies, uniform_grid(4.5, 0.25, 4, 4, 4));
}

TEST_CASE("Borders of tiles, of units and of chunks along the rays leave no trace") {
  const auto lattice = [](uint64_t seed, double size) {
    std::mt19937_64 random(seed);
    return std::vector<Body>{{shapes::join(shapes::random_tetrahedra(random, 3, -2, size, 0.5))},
                             {shapes::sphere({size / 2, 34, 4}, 30, 2, 0.25), Rule::kNonzero, 2},
                             {shapes::box({63.5, 1.5, 0.5}, {64.5, 66.5, 8.5}), Rule::kNonzero, 3}};
  };
  expect_exact(lattice(300, 130), uniform_grid(0, 1, 130, 67, 9));
  expect_exact(lattice(301, 262), uniform_grid(0, 1, 262, 65, 5));
}

TEST_CASE("Far from the origin, where neighbouring centres share most of their digits, cells equal rational arithmetic") {
  for (const double far : {1e6, -3e9, 1e12}) {
    auto facets = shapes::join({shapes::sphere({4, 4, 4}, 3, 2), shapes::tetrahedron({0.5, 0.5, 0.5}, {7.5, 1.5, 2.5}, {1.5, 6.5, 3.5}, {2.5, 2.5, 7.5})});
    expect_exact({{shapes::translate(facets, {far, far, far})}}, uniform_grid(far, 0.25, 32, 32, 32));
  }
}

TEST_CASE("Volumes of spheres and tori converge to the analytic ones") {
  const TempFolder folder;
  for (const auto& [facets, exact] : {std::pair{shapes::sphere({0, 0, 0}, 1, 6), 4.18879020478639}, {shapes::torus({0, 0, 0}, 0.7, 0.3, 400, 200), 1.24357}}) {
    double last = 1;
    for (const int n : {32, 128}) {
      const Grid grid = uniform_grid(-1.1, 2.2 / n, n, n, n);
      mesh_quietly(scene_of(folder, {{facets}}, grid), folder / "g.tcell");
      const GridReader reader(folder / "g.tcell");
      const double error = std::abs(read_stats(reader, grid.box(0))[1].volume / exact - 1);
      INFO(n << " cells, volume off by " << error);
      REQUIRE(error < 1.0 / n);
      REQUIRE(error < last);
      last = error;
    }
  }
}

TEST_CASE("The file's bytes do not depend on the number of threads", "[threads]") {
  const TempFolder folder;
  const std::vector<Body> bodies = {{shapes::sphere({100, 100, 100}, 90, 4)}, {shapes::torus({100, 100, 120}, 60, 20, 40, 30), Rule::kNonzero, 2}};
  const Scene scene = scene_of(folder, bodies, uniform_grid(0, 0.37, 540, 540, 540));
  MeshOptions options;
  std::string first;
  for (const int threads : {1, 2, 5}) {
    options.threads = threads;
    mesh_quietly(scene, folder / "g.tcell", options);
    if (first.empty()) first = bytes_of(folder / "g.tcell");
    REQUIRE(bytes_of(folder / "g.tcell") == first);
  }
}

TEST_CASE("A body under a stronger one owns no cell and is named in a warning") {
  const TempFolder folder;
  const auto box = shapes::box({0, 0, 0}, {2, 2, 2});
  const auto report = mesh_quietly(scene_of(folder, {{box}, {box, Rule::kNonzero, 2}}, uniform_grid(-1, 0.5, 8, 8, 8)), folder / "g.tcell");
  REQUIRE(report["bodies"][0]["cells"] == 0);
  REQUIRE(report["bodies"][1]["cells"] == 64);
  REQUIRE(report["warnings"].size() == 1);
  REQUIRE_THAT(report["warnings"][0].get<std::string>(), Catch::Contains("body0"));
}

}  // namespace
}  // namespace teracell
