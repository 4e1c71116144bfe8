// Reliefs: sheets that are closed by walls down to beyond the domain.
#include "mesher/closing/extrude.hpp"
#include "tests/support/every_way.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Body;
using oracle::Rule;
using shapes::Facets;

constexpr int kSteps = 8;  // squares along a side of a relief

// Heights on a lattice of kSteps + 1 points a side, so that sample points lie on facets; `axis` is up. Facets run
// anticlockwise seen from above. Squares for which `hole` is true are missing.
template <class Hole>
Facets relief(std::mt19937_64& random, int axis, Hole&& hole) {
  const RayFrame f = RayFrame::along(axis);
  std::array<std::array<Vec3, kSteps + 1>, kSteps + 1> at;
  for (int i = 0; i <= kSteps; ++i)
    for (int j = 0; j <= kSteps; ++j) at[i][j][f.u] = i, at[i][j][f.v] = j, at[i][j][f.w] = 3 + random_int(random, 0, 8) * 0.25;
  Facets out;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < kSteps; ++j) {
      if (hole(i, j)) continue;
      out.push_back({{at[i][j], at[i + 1][j], at[i + 1][j + 1]}});
      out.push_back({{at[i][j], at[i + 1][j + 1], at[i][j + 1]}});
    }
  return axis == 1 ? shapes::flip(out) : out;  // x, z is a left-handed frame
}

// The relief with walls and a floor at `floor`, put together by hand: each facet with the prism below it.
Facets filled(const Facets& top, int axis, double floor) {
  Facets out;
  for (const Facet& f : top) {
    std::array<Vec3, 3> low = f.vertex;
    for (Vec3& p : low) p[axis] = floor;
    out.push_back(f);
    out.push_back({{low[0], low[2], low[1]}});
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3;
      out.push_back({{f.vertex[k], f.vertex[i], low[i]}});
      out.push_back({{f.vertex[k], low[i], low[k]}});
    }
  }
  return out;
}

Grid grid_of(bool graded) {
  const Axis uniform = Axis::uniform(-0.5, 0.5, 0, 18, 0.5);
  return {{graded ? Axis::graded({-1, 0, 1, 1.5, 3, 4.25, 5, 7, 9}, 0.5) : uniform, uniform,
           graded ? Axis::graded({-0.5, 1, 2, 3.5, 4.5, 8.5}, 0.5) : uniform}};
}

TEST_CASE("An extruded relief has the cells of the relief closed by hand, along every axis, on either side") {
  const TempFolder folder;
  for (uint64_t seed = 0; seed < rounds(12); ++seed) {
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    const int axis = static_cast<int>(seed % 3);
    const bool up = seed % 2 == 1, evenodd = seed % 5 == 4;
    const Facets top = relief(random, axis, [](int, int) { return false; });
    const Grid grid = grid_of(seed % 4 > 1);
    const auto expected = oracle::materials({{filled(top, axis, up ? 1000 : -1000), evenodd ? Rule::kEvenodd : Rule::kNonzero}}, grid);
    Scene scene = scene_of(folder, {{top}}, grid);
    scene.bodies[0].closing = {Closing::Way::kExtrude, axis, up};
    scene.bodies[0].fill = evenodd ? Fill::kEvenodd : Fill::kAuto;
    for (int rays = 0; rays < 3; ++rays) {
      MeshOptions options{.axis = rays};
      options.memory = rays == 1 ? 1 : options.memory;  // spilled
      const auto report = mesh_quietly(scene, folder / "g.tcell", options);
      REQUIRE((all_cells(GridReader(folder / "g.tcell")) == expected));
      REQUIRE(report["bodies"][0]["holes"].size() == 1);
      CHECK(report["bodies"][0]["holes"][0]["extruded"] == true);
      CHECK(report["bodies"][0]["holes"][0]["edges"] == 4 * kSteps);
      CHECK(report["bodies"][0]["holes"][0]["cap_area"] == Approx(kSteps * kSteps));
    }
  }
}

TEST_CASE("Holes within a relief are capped: no shaft reaches down from them") {
  const TempFolder folder;
  for (const bool evenodd : {false, true}) {
    std::mt19937_64 random(3);
    const Facets top = relief(random, 2, [](int i, int j) { return (i == 2 || i == 5) && j == 3; });
    Scene scene = scene_of(folder, {{top}}, grid_of(false));
    scene.bodies[0].closing = {Closing::Way::kExtrude, 2, false};
    if (evenodd) scene.bodies[0].fill = Fill::kEvenodd;
    const auto report = mesh_quietly(scene, folder / "g.tcell");
    const auto& holes = report["bodies"][0]["holes"];
    REQUIRE(holes.size() == 3);
    CHECK(holes[0].contains("extruded"));
    CHECK_FALSE(holes[1].contains("extruded"));
    CHECK_FALSE(holes[2].contains("extruded"));
    const auto cells = all_cells(GridReader(folder / "g.tcell"));
    for (int x = 1; x < 17; ++x)
      for (int y = 1; y < 17; ++y) REQUIRE(cells[(5 * 18 + y) * 18 + x] == 1);  // below all of the relief
  }
}

TEST_CASE("An extruded relief that is moved by a matrix is drawn out along the grid's axis") {
  const TempFolder folder;
  std::mt19937_64 random(5);
  const Facets top = relief(random, 0, [](int, int) { return false; });
  Scene scene = scene_of(folder, {{top}}, grid_of(false));
  scene.bodies[0].matrix = {0, 1, 0, 0, 0, 0, 1, 0, 1, 0, 0, 0};  // x is up in the file, z in the grid
  scene.bodies[0].closing = {Closing::Way::kExtrude, 2, false};
  Facets moved = top;
  for (Facet& f : moved)
    for (Vec3& v : f.vertex) v = transform(scene.bodies[0].matrix, v);
  for (const uint64_t memory : {~uint64_t{0}, uint64_t{1}}) {
    mesh_quietly(scene, folder / "g.tcell", {.memory = memory, .write_caps = folder / "whole.ply"});
    const auto cells = all_cells(GridReader(folder / "g.tcell"));
    REQUIRE((cells == oracle::materials({{filled(moved, 2, -1000)}}, grid_of(false))));
    // What is written is the body as the grid sees it, closed.
    const Facets whole = shapes::facets_in(folder / "whole.ply");
    REQUIRE(oracle::is_closed(whole, Rule::kNonzero));
    REQUIRE((cells == oracle::materials({{whole}}, grid_of(false))));
  }
}

TEST_CASE("Of a shell's loops those go whose signed area has the sign of the largest one's") {
  const Loop large = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}}, hole = {{1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0}},
             beside = {{5, 0, 0}, {6, 0, 0}, {6, 1, 0}};
  CHECK(outer_loops({hole, large, beside}, 2, false) == std::vector<bool>{false, true, true});
  CHECK(outer_loops({hole, large, beside}, 2, true) == std::vector<bool>{false, true, true});
  const Loop turned(hole.rbegin(), hole.rend());
  CHECK(outer_loops({turned, large}, 2, false) == std::vector<bool>{true, true});
  CHECK(outer_loops({turned, large}, 2, true) == std::vector<bool>{false, true});  // without a sign: inside another one
}

}  // namespace
}  // namespace teracell::mesher
