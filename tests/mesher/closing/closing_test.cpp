// Open surfaces: boundary, loops, caps, and the fill rule of each shell.
#include "mesher/bodies/bodies.hpp"
#include "store/base/error.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/every_way.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Body;
using oracle::Rule;
using shapes::Facets;

FacetPass pass_over(const Facets& facets) {
  return [&facets](const auto& f) {
    for (const Facet& facet : facets) f(facet);
  };
}

std::vector<BoundaryEdge> boundary(const Facets& facets) { return boundary_edges(pass_over(facets), 1 << 24, "test"); }

Caps caps_of(const Facets& facets, bool evenodd, bool float32 = false) {
  auto edges = boundary(facets);
  if (evenodd) std::erase_if(edges, [](const BoundaryEdge& e) { return !e.odd(); });
  Caps caps;
  for (const Loop& loop : cut_into_loops(edges, evenodd)) cap_loop(loop, float32, kIdentity, caps);
  std::ranges::stable_sort(caps.holes, std::ranges::greater{}, &Hole::diameter);
  return caps;
}

// Facets between few points: every edge is used often, in both directions.
Facets soup(std::mt19937_64& random, int facets, int points) {
  std::vector<Vec3> p(points);
  for (Vec3& v : p)
    for (double& x : v) x = std::uniform_int_distribution<int>(0, 8)(random);
  Facets out;
  std::uniform_int_distribution<size_t> any(0, p.size() - 1);
  for (int i = 0; i < facets; ++i) out.push_back({{p[any(random)], p[any(random)], p[any(random)]}});
  return out;
}

Facets without(Facets facets, std::initializer_list<size_t> gone) {
  Facets out;
  for (size_t i = 0; i < facets.size(); ++i)
    if (std::ranges::find(gone, i) == gone.end()) out.push_back(facets[i]);
  return out;
}

nlohmann::ordered_json meshed(const TempFolder& folder, const Facets& facets, Fill fill, const Grid& grid, const std::string& name = "g.tcell") {
  Scene scene = scene_of(folder, {{facets}}, grid);
  scene.bodies[0].fill = fill;
  return mesh_quietly(scene, folder / name);
}

TEST_CASE("The boundary is what edges counted one by one leave, whatever the memory") {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    std::mt19937_64 random(seed);
    const Facets facets = soup(random, 60, 9);
    std::map<std::pair<Vec3, Vec3>, std::pair<int64_t, uint64_t>> counted;  // net and uses
    for (const Facet& f : facets)
      for (int i = 0; i < 3; ++i) {
        const Vec3 &a = f.vertex[i], &b = f.vertex[(i + 1) % 3];
        if (a == b) continue;
        auto& [net, uses] = counted[{std::min(a, b), std::max(a, b)}];
        net += a < b ? 1 : -1;
        ++uses;
      }
    std::erase_if(counted, [](const auto& c) { return c.second.first == 0; });
    for (const uint64_t memory : {uint64_t{1} << 13, uint64_t{1} << 30}) {
      const auto found = boundary_edges(pass_over(facets), memory, "test");
      REQUIRE(found.size() == counted.size());
      auto expected = counted.begin();
      for (const BoundaryEdge& e : found) {
        const auto& [edge, count] = *expected++;
        CHECK(std::min(e.from, e.to) == edge.first);
        CHECK(std::max(e.from, e.to) == edge.second);
        CHECK((e.from < e.to) == (count.first > 0));
        CHECK(static_cast<int64_t>(e.net) == std::abs(count.first));
        CHECK(e.uses == count.second);
      }
    }
  }
}

TEST_CASE("A surface too loose for the memory is an error") {
  std::mt19937_64 random(1);
  const Facets facets = soup(random, 2000, 1000);
  REQUIRE_THROWS_WITH(boundary_edges(pass_over(facets), 10000, "loose.stl"), Catch::Contains("loose.stl") && Catch::Contains("memory"));
}

TEST_CASE("A surface with its caps has no boundary, however torn it is") {
  for (uint64_t seed = 0; seed < 40; ++seed) {
    std::mt19937_64 random(seed);
    const Facets facets = soup(random, 40, 8);
    for (const bool evenodd : {false, true}) {
      const Caps caps = caps_of(facets, evenodd);
      REQUIRE(oracle::is_closed(shapes::join({facets, caps.facets}), evenodd ? Rule::kEvenodd : Rule::kNonzero));
    }
  }
}

TEST_CASE("The caps do not depend on the order of the facets") {
  std::mt19937_64 random(7);
  Facets facets = soup(random, 40, 8);
  const Caps first = caps_of(facets, false);
  std::ranges::shuffle(facets, random);
  const Caps second = caps_of(facets, false);
  REQUIRE(first.facets.size() == second.facets.size());
  for (size_t i = 0; i < first.facets.size(); ++i) REQUIRE(first.facets[i].vertex == second.facets[i].vertex);
}

TEST_CASE("A missing square is one hole: its loop, its diameter, the area of its cap") {
  const Caps caps = caps_of(without(shapes::box({0, 0, 0}, {2, 2, 2}), {0, 1}), false);
  REQUIRE(caps.holes.size() == 1);
  CHECK(caps.holes[0].edges == 4);
  CHECK(caps.holes[0].cap_area == Approx(4));
  CHECK(caps.holes[0].diameter == Approx(2 * std::sqrt(2.0)));
  CHECK(caps.facets.size() == 4);
}

TEST_CASE("Loops are cut where they touch: two holes that share a corner are two caps") {
  // Two triangles missing around one vertex of a sphere.
  const Facets whole = shapes::sphere({0, 0, 0}, 4, 2);
  const Vec3 corner = whole[0].vertex[0];
  std::vector<size_t> around;
  for (size_t i = 0; i < whole.size(); ++i)
    if (std::ranges::find(whole[i].vertex, corner) != whole[i].vertex.end()) around.push_back(i);
  const auto shares_edge = [&](size_t a, size_t b) {
    int shared = 0;
    for (const Vec3& v : whole[a].vertex) shared += std::ranges::find(whole[b].vertex, v) != whole[b].vertex.end();
    return shared == 2;
  };
  size_t other = around[1];
  for (const size_t i : around)
    if (i != around[0] && !shares_edge(around[0], i)) other = i;
  const Caps caps = caps_of(without(whole, {around[0], other}), false);
  REQUIRE(caps.holes.size() == 2);
  CHECK(caps.holes[0].edges == 3);
  CHECK(caps.holes[1].edges == 3);
}

TEST_CASE("An edge that is open twice gets two facets") {
  const Facets open = without(shapes::box({0, 0, 0}, {2, 2, 2}), {0});
  const Caps caps = caps_of(shapes::join({open, open}), false);
  REQUIRE(caps.facets.size() == 6);
  REQUIRE(oracle::is_closed(shapes::join({open, open, caps.facets}), Rule::kNonzero));
}

TEST_CASE("The apex is float32 when all vertices are") {
  Facets open = without(shapes::sphere({0, 0, 0}, 4, 1), {3});
  for (Facet& f : open)
    for (Vec3& p : f.vertex)
      for (double& x : p) x = static_cast<float>(x);
  const Vec3 exact = caps_of(open, false).facets[0].vertex[2], rounded = caps_of(open, false, true).facets[0].vertex[2];
  for (int d = 0; d < 3; ++d) CHECK(rounded[d] == static_cast<float>(exact[d]));
}

TEST_CASE("A box with a missing facet has the cells of the box") {
  const TempFolder folder;
  const Grid grid = cube_grid_of(-1, 0.5, 10);
  const Facets box = shapes::box({0.25, 0.25, 0.25}, {2.75, 2.75, 2.75});
  const auto expected = oracle::materials({{box}}, grid);
  for (const Facets& open : {without(box, {4}), without(box, {0, 1}), without(box, {2, 7})}) {
    const auto report = meshed(folder, open, Fill::kAuto, grid);
    REQUIRE(all_cells(GridReader(folder / "g.tcell")) == expected);
    CHECK(report["bodies"][0]["fill"][0]["rule"] == "nonzero");
    CHECK(report["bodies"][0]["holes"].size() >= 1);
    REQUIRE(report["warnings"].size() >= 1);
    CHECK_THAT(report["warnings"][0].get<std::string>(), Catch::Contains("is open"));
    for (size_t i = 1; i < report["warnings"].size(); ++i)  // half of a side missing: the winding number may doubt the cap, nothing else is wrong
      CHECK_THAT(report["warnings"][i].get<std::string>(), Catch::Contains("look at its caps"));
  }
}

TEST_CASE("Torn surfaces have the cells of surface and caps together, by rational arithmetic") {
  const Grid grid = cube_grid_of(-0.5, 0.5, 18);
  for_seeds(0, rounds(12), [&](auto& random) {
    const TempFolder folder;
    const Facets facets = soup(random, 25, 10);
    for (const Fill fill : {Fill::kNonzero, Fill::kEvenodd}) {
      const bool evenodd = fill == Fill::kEvenodd;
      const Body closed{shapes::join({facets, caps_of(facets, evenodd).facets}), evenodd ? Rule::kEvenodd : Rule::kNonzero};
      Scene scene = scene_of(folder, {{facets}}, grid);
      scene.bodies[0].fill = fill;
      const auto expected = oracle::materials({closed}, grid);
      for_axes(scene, {}, [&](const GridReader& reader, const auto&) { REQUIRE(all_cells(reader) == expected); });
    }
  });
}

TEST_CASE("Two overlapping boxes in one file, one facet of one flipped, are their union") {
  const TempFolder folder;
  const Grid grid = cube_grid_of(-1, 0.5, 14);
  const Facets a = shapes::box({0, 0, 0}, {3, 3, 3}), b = shapes::box({1, 1, 1}, {5, 5, 5});
  const auto expected = oracle::materials({{a}, {b}}, grid);
  for (size_t flipped = 0; flipped < 24; ++flipped) {
    Facets both = shapes::join({a, b});
    both[flipped] = shapes::flip({both[flipped]})[0];
    const auto report = meshed(folder, both, Fill::kAuto, grid);
    REQUIRE(all_cells(GridReader(folder / "g.tcell")) == expected);
    CHECK(report["bodies"][0]["shells"] == 2);
    CHECK(report["bodies"][0]["fill"][0]["shells"] == 1);
    CHECK(report["bodies"][0]["fill"][1]["rule"] == "evenodd");
    CHECK(report["bodies"][0]["flips"][0]["edges"] == 3);
  }
}

TEST_CASE("A surface whose only shell has a flipped facet is meshed by parity") {
  const TempFolder folder;
  Facets box = shapes::box({0, 0, 0}, {2, 2, 2});
  box[3] = shapes::flip({box[3]})[0];
  const auto report = meshed(folder, box, Fill::kAuto, cube_grid_of(-1, 0.5, 8));
  REQUIRE(report["bodies"][0]["fill"].size() == 1);
  CHECK(report["bodies"][0]["fill"][0]["rule"] == "evenodd");
  CHECK(report["bodies"][0]["cells"] == 64);
}

TEST_CASE("Closing strict refuses an open surface and describes its boundary") {
  const TempFolder folder;
  Scene scene = scene_of(folder, {{without(shapes::box({0, 0, 0}, {1, 1, 1}), {11})}}, cube_grid_of(-1, 0.5, 6));
  scene.bodies[0].closing.way = Closing::Way::kStrict;
  REQUIRE_THROWS_WITH(mesh_quietly(scene, folder / "g.tcell"), Catch::Contains("not closed") && Catch::Contains("3 edges"));
  REQUIRE_FALSE(std::filesystem::exists(folder / "g.tcell"));
  REQUIRE_FALSE(std::filesystem::exists(folder / "g.tcell.partial"));
}

TEST_CASE("Written caps close the surface: surface and caps as one file have the same cells") {
  const TempFolder folder;
  const Grid grid = cube_grid_of(-5, 0.25, 40);
  const Facets open = without(shapes::sphere({0, 0, 0}, 4, 3), {3, 4, 77, 78, 79, 200});
  for (const char* name : {"caps.ply", "caps.stl"}) {
    const bool doubles = std::string(name) == "caps.ply";
    Scene scene = scene_of(folder, {{open}}, grid);
    if (!doubles) {
      shapes::write_stl(folder / "body0.stl", open, shapes::Encoding::kLittleEndian);
      scene.bodies[0].mesh = folder / "body0.stl";
    }
    const MeshOptions options{.write_caps = folder / name};
    mesh_quietly(scene, folder / "open.tcell", options);
    Facets whole;
    for (const auto& path : {scene.bodies[0].mesh, options.write_caps}) whole = shapes::join({whole, shapes::facets_in(path)});
    REQUIRE(oracle::is_closed(whole, Rule::kNonzero));
    const auto report = meshed(folder, whole, Fill::kAuto, grid, "whole.tcell");
    CHECK(report["bodies"][0]["holes"].empty());
    REQUIRE(all_cells(GridReader(folder / "open.tcell")) == all_cells(GridReader(folder / "whole.tcell")));
  }
}

TEST_CASE("Caps of doubles don't fit into STL, and nothing is written") {
  const TempFolder folder;
  const Scene scene = scene_of(folder, {{without(shapes::sphere({0, 0, 0}, 4, 1), {3})}}, cube_grid_of(-5, 1, 10));
  const MeshOptions options{.write_caps = folder / "caps.stl"};
  REQUIRE_THROWS_WITH(mesh_quietly(scene, folder / "g.tcell", options), Catch::Contains(".ply"));
  REQUIRE_FALSE(std::filesystem::exists(folder / "caps.stl"));
  REQUIRE_FALSE(std::filesystem::exists(folder / "g.tcell"));
}

TEST_CASE("How far the edge of a hole is off a plane", "[closing]") {
  const auto off = [](const Loop& loop) { return measure_hole(loop, apex_of(loop, false)).off_plane; };
  // Forth and back along a zigzag: it encloses nothing, and is flat only if the zigzag is.
  CHECK(off({{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {1, 1, 0}}) == Approx(0).margin(1e-12));
  CHECK(off({{0, 0, 0}, {1, 1, 0}, {2, 0, 1}, {3, 1, 3}, {2, 0, 1}, {1, 1, 0}}) > 0.1);
  CHECK(off({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {1, 1, 1}}) == Approx(0).margin(1e-12));
  CHECK(off({{0, 0, 1}, {2, 0, 1}, {2, 3, 1}, {0, 3, 1}}) == 0);
  CHECK(off({{0, 0, 0}, {2, 0, 2}, {2, 3, 2}, {0, 3, 0}}) < 1e-15);  // aslant
  CHECK(off({{0, 0, 0.5}, {2, 0, -0.5}, {2, 2, 0.5}, {0, 2, -0.5}}) == Approx(0.5));  // a saddle
  CHECK(off({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}}) == 0);                                 // no area, so no plane
}

}  // namespace
}  // namespace teracell::mesher
