// The cells themselves: meshed scenes against rational arithmetic, analytic solids and each other.
#include <set>

#include "store/read/stats.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/every_way.hpp"
#include "tests/support/ties.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Body;
using oracle::Rule;

// Of which cells each body holds the sample point, whoever owns them: 1 or 0.
std::vector<std::vector<uint32_t>> held(const std::vector<Body>& bodies, const Grid& grid) {
  std::vector<std::vector<uint32_t>> out;
  for (const Body& body : bodies) out.push_back(oracle::materials({{body.facets, body.rule, 1}}, grid));
  return out;
}

// The list of the report, by looking at every cell. A body's name is body and its number.
nlohmann::ordered_json overlaps_of(const std::vector<Body>& bodies, const std::vector<std::vector<uint32_t>>& held, const Grid& grid) {
  const auto stronger = [&](size_t a, size_t b) {
    return bodies[a].priority != bodies[b].priority ? bodies[a].priority > bodies[b].priority : a > b;
  };
  const auto name = [](size_t b) { return fmt::format("body{}", b); };
  const Index3 n = grid.cells();
  std::vector<nlohmann::ordered_json> list;
  for (size_t a = 0; a < bodies.size(); ++a)
    for (size_t b = a + 1; b < bodies.size(); ++b) {
      size_t cells = 0;
      Box box{n, {0, 0, 0}};
      Vec3 at{};
      bool third = false;
      for (size_t i = 0; i < held[a].size(); ++i) {
        if (held[a][i] == 0 || held[b][i] == 0) continue;
        const auto cell = static_cast<int64_t>(i);
        const Index3 c{cell % n[0], cell / n[0] % n[1], cell / n[0] / n[1]};
        for (int d = 0; d < 3; ++d) {
          box.lo[d] = std::min(box.lo[d], c[d]), box.hi[d] = std::max(box.hi[d], c[d] + 1);
          if (cells == 0) at[d] = grid.axis[d].centre(c[d]);
        }
        for (size_t o = 0; o < bodies.size(); ++o) third |= o != a && o != b && held[o][i] != 0 && stronger(o, a) && stronger(o, b);
        ++cells;
      }
      if (cells == 0) continue;
      nlohmann::ordered_json owner;
      if (!third) owner = name(stronger(a, b) ? a : b);
      list.push_back({{"bodies", {name(a), name(b)}},
                      {"cells", cells},
                      {"owner", owner},
                      {"box", {box.lo[0], box.lo[1], box.lo[2], box.hi[0], box.hi[1], box.hi[2]}},
                      {"at", at}});
    }
  std::ranges::stable_sort(list, [](const auto& x, const auto& y) { return x["cells"] > y["cells"]; });
  return {{"pairs", list.size()}, {"list", list}};
}

// Where overlaps have labels of their own, exactly the cells whose sample points lie in several bodies have them; all else stays as it is.
void expect_overlaps_apart(const Scene& scene, const std::vector<std::vector<uint32_t>>& held, const std::string& hash) {
  const auto first_label = [](const std::vector<Label>& set) { return set.front(); };
  Scene apart = scene;
  apart.label_by = LabelBy::kOverlap;
  const TempFolder folder;
  mesh_quietly(apart, folder / "g.tcell", {.axis = static_cast<int>(held.size() % 3), .threads = 1});  // one axis for each scene is enough
  const GridReader reader(folder / "g.tcell");
  const Index3 n = reader.meta().grid.cells();
  std::vector<uint32_t> labels(static_cast<size_t>(n[0] * n[1] * n[2]));
  read_box<uint32_t>(reader, 0, reader.meta().grid.box(0), first_label, 0, labels.data(), {1, n[0], n[0] * n[1]});
  size_t differ = 0;
  for (size_t i = 0; i < labels.size(); ++i) {
    const auto bodies = std::ranges::count_if(held, [&](const auto& in) { return in[i] != 0; });
    differ += reader.meta().labels[labels[i]].overlap != (bodies > 1);
  }
  REQUIRE(differ == 0);
  REQUIRE(reader.meta().labels_hash == hash);
}

// Meshes along x, y and z; each must give exactly what rational arithmetic gives.
void expect_exact(const std::vector<Body>& bodies, const Grid& grid) {
  const TempFolder folder;
  const std::vector<uint32_t> expected = oracle::materials(bodies, grid);
  const std::vector<std::vector<uint32_t>> in_body = held(bodies, grid);
  const auto overlaps = overlaps_of(bodies, in_body, grid);
  std::set<std::string> hashes;
  Scene scene = scene_of(folder, bodies, grid);
  scene.label_by = LabelBy::kBody;
  for_axes(scene, {.threads = 1}, [&](const GridReader& reader, const nlohmann::ordered_json& report) {
    for (size_t b = 0; b < bodies.size(); ++b)
      REQUIRE(report["bodies"][b]["cells"].get<int64_t>() + report["bodies"][b].value("covered_cells", int64_t{0}) ==
              std::ranges::count(in_body[b], 1u));
    REQUIRE(report["overlaps"] == overlaps);
    REQUIRE(reader.meta().grid == grid);
    const std::vector<uint32_t> found = all_cells(reader);
    size_t differ = 0;
    for (size_t i = 0; i < found.size(); ++i) differ += found[i] != expected[i];
    INFO(found.size() << " cells");
    REQUIRE(differ == 0);
    hashes.insert(reader.meta().labels_hash);
  });
  REQUIRE((hashes.size() == 1 && !hashes.contains("")));
  if (bodies.size() > 1) expect_overlaps_apart(scene, in_body, *hashes.begin());
}

TEST_CASE("A box owns its lower faces and not its upper ones, whatever the ray axis") {
  const Grid grid = cube_grid_of(0, 1, 6);
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
  expect_exact(bodies, cube_grid_of(0, 1, 9));
  expect_exact(bodies, cube_grid_of(0, 0.5, 18));
}

TEST_CASE("Random scenes full of exact ties equal rational arithmetic along every axis") {
  for_seeds(0, rounds(40), [](auto& random) {
    const int n = random_int(random, 5, 11);
    const std::vector<Body> bodies = shapes::bodies_of_ties(random, n, 5);
    expect_exact(bodies, shapes::grid_of_ties(random, n));
  });
}

TEST_CASE("Decimal lattices, whose ties miss by a rounding, equal rational arithmetic") {
  for_seeds(100, 12, [](auto& random) { expect_exact(shapes::decimal_bodies(random, 3), cube_grid_of(0, 1.1 / 11, 11)); });
}

TEST_CASE("Needles and near-vertical facets, where doubles lose the slope, equal rational arithmetic") {
  for_seeds(200, 12, [](auto& random) {
    std::vector<Body> bodies;
    for (uint32_t material = 1; material <= 4; ++material) {
      bodies.push_back({shapes::needle(random), Rule::kNonzero, material});
      bodies.push_back({shapes::sheet(random), Rule::kNonzero, 5});
    }
    expect_exact(bodies, cube_grid_of(0, 1, 10));
  });
}

TEST_CASE("A grid that cuts through a body, or lies wholly inside it, is the window of the larger grid") {
  const std::vector<Body> bodies = {{shapes::sphere({5, 5, 5}, 4, 2, 0.5)}, {shapes::box({-20, -20, -20}, {20, 20, 5}), Rule::kNonzero, 2, -1}};
  expect_exact(bodies, uniform_grid(3, 0.5, {7, 9, 5}));
  expect_exact(bodies, cube_grid_of(4.5, 0.25, 4));
}

TEST_CASE("Borders of tiles, of tile groups and of chunks along the rays leave no trace") {
  const auto lattice = [](uint64_t seed, double size) {
    std::mt19937_64 random(seed);
    return std::vector<Body>{{shapes::join(shapes::random_tetrahedra(random, 3, -2, size, 0.5))},
                             {shapes::sphere({size / 2, 34, 4}, 30, 2, 0.25), Rule::kNonzero, 2},
                             {shapes::box({63.5, 1.5, 0.5}, {64.5, 66.5, 8.5}), Rule::kNonzero, 3}};
  };
  expect_exact(lattice(300, 130), uniform_grid(0, 1, {130, 67, 9}));
  expect_exact(lattice(301, 262), uniform_grid(0, 1, {262, 65, 5}));
}

TEST_CASE("Far from the origin, where neighbouring centres share most of their digits, cells equal rational arithmetic") {
  for (const double far : {1e6, -3e9, 1e12}) {
    auto facets =
        shapes::join({shapes::sphere({4, 4, 4}, 3, 2), shapes::tetrahedron({0.5, 0.5, 0.5}, {7.5, 1.5, 2.5}, {1.5, 6.5, 3.5}, {2.5, 2.5, 7.5})});
    expect_exact({{shapes::translate(facets, {far, far, far})}}, cube_grid_of(far, 0.25, 32));
  }
}

TEST_CASE("Volumes of spheres and tori converge to the analytic ones") {
  for (const auto& [facets, exact] :
       {std::pair{shapes::sphere({0, 0, 0}, 1, 6), 4.18879020478639}, {shapes::torus({0, 0, 0}, 0.7, 0.3, 400, 200), 1.24357}}) {
    double last = 1;
    for (const int n : {32, 128}) {
      const Grid grid = cube_grid_of(-1.1, 2.2 / n, n);
      const GridReader reader = meshed_reader({{facets}}, grid);
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
  const Scene scene = scene_of(folder, bodies, cube_grid_of(0, 0.37, 540));
  MeshOptions options;
  std::string first;
  for (const int threads : {1, 2, 5}) {
    options.threads = threads;
    mesh_quietly(scene, folder / "g.tcell", options);
    if (first.empty()) first = bytes_of(folder / "g.tcell");
    REQUIRE(bytes_of(folder / "g.tcell") == first);
  }
}

TEST_CASE("Sheets overlap nothing, and neither do cells that a body only keeps") {
  const TempFolder folder;
  const std::vector<Body> bodies = {{shapes::box({1, 1, 1}, {7, 7, 7})},
                                    {shapes::box({2, 2, 3.6}, {6, 6, 3.9}), Rule::kNonzero, 2},
                                    {shapes::box({0.5, 0.5, 0.5}, {7.5, 7.5, 7.5}), Rule::kNonzero, 3, 0, true}};
  Scene scene = scene_of(folder, bodies, cube_grid_of(0, 1, 8));
  scene.bodies[1].thin = Thin::kKeep;
  const auto report = mesh_quietly(scene, folder / "g.tcell");
  REQUIRE(report["bodies"][1]["cells"] == 16);
  REQUIRE(report["overlaps"].dump() == R"({"pairs":0,"list":[]})");
}

TEST_CASE("A body under a stronger one owns no cell and is named in a warning") {
  const TempFolder folder;
  const auto box = shapes::box({0, 0, 0}, {2, 2, 2});
  const auto report = mesh_quietly(scene_of(folder, {{box}, {box, Rule::kNonzero, 2}}, cube_grid_of(-1, 0.5, 8)), folder / "g.tcell");
  REQUIRE(report["bodies"][0]["cells"] == 0);
  REQUIRE(report["bodies"][0]["covered_cells"] == 64);
  REQUIRE(report["bodies"][1]["cells"] == 64);
  REQUIRE_FALSE(report["bodies"][1].contains("covered_cells"));
  REQUIRE(report["warnings"].size() == 1);
  REQUIRE_THAT(report["warnings"][0].get<std::string>(), Catch::Contains("body0"));
}

}  // namespace
}  // namespace teracell::mesher
