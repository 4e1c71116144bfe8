// Sheets: the cells that a surface passes through, against rational arithmetic.
#include "tests/support/cube_grid.hpp"
#include "tests/support/every_way.hpp"
#include "tests/support/ties.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using oracle::Body;
using oracle::Rule;
using shapes::Facets;

Body sheet(Facets facets, uint32_t material = 1, int64_t priority = 0) { return {std::move(facets), Rule::kNonzero, material, priority, true}; }

// Facets with corners on multiples of 1/4 (and 1/2: sample points and planes) that are joined to nothing, needles and facets
// along the axes among them.
Facets soup(std::mt19937_64& random, int count, int n) {
  Facets facets;
  for (int i = 0; i < count; ++i) {
    Facet f;
    const double lattice = random_int(random, 0, 1) == 0 ? 0.5 : 0.25;
    for (Vec3& p : f.vertex)
      for (double& x : p) x = random_int(random, static_cast<int>(-1 / lattice), static_cast<int>((n + 1) / lattice)) * lattice;
    if (const int d = random_int(random, 0, 5); d < 3) f.vertex[1][d] = f.vertex[2][d] = f.vertex[0][d];
    facets.push_back(f);
  }
  return facets;
}

std::vector<uint32_t> meshed(const TempFolder& folder, const std::vector<Body>& bodies, const Grid& grid) {
  mesh_quietly(scene_of(folder, bodies, grid), folder / "g.tcell");
  return all_cells(GridReader(folder / "g.tcell"));
}

// Along each axis, by each engine.
void expect_exact_sheets(const std::vector<Body>& bodies, const Grid& grid) {
  const TempFolder folder;
  const std::vector<uint32_t> expected = oracle::materials(bodies, grid);
  for_engines_and_axes(scene_of(folder, bodies, grid), {}, [&](const GridReader& reader, const auto&) { REQUIRE(all_cells(reader) == expected); });
}

TEST_CASE("A sheet owns the cells whose planes its crossing lies between; a surface on a plane belongs to the cell below", "[sheet]") {
  const Grid grid = cube_grid_of(0, 1, 6);
  const TempFolder folder;
  const auto cells_of = [&](double z) {
    const Facets square = {{{Vec3{0, 0, z}, Vec3{6, 0, z}, Vec3{6, 6, z}}}, {{Vec3{0, 0, z}, Vec3{6, 6, z}, Vec3{0, 6, z}}}};
    expect_exact_sheets({sheet(square)}, grid);
    std::vector<size_t> layers(6);
    const auto cells = meshed(folder, {sheet(square)}, grid);
    for (size_t i = 0; i < cells.size(); ++i) layers[i / 36] += cells[i];
    return layers;
  };
  CHECK(cells_of(2.5) == std::vector<size_t>{0, 0, 36, 0, 0, 0});
  CHECK(cells_of(2.75) == std::vector<size_t>{0, 0, 36, 0, 0, 0});
  CHECK(cells_of(3) == std::vector<size_t>{0, 0, 36, 0, 0, 0});
  CHECK(cells_of(6) == std::vector<size_t>{0, 0, 0, 0, 0, 36});
  CHECK(cells_of(0) == std::vector<size_t>(6));
}

TEST_CASE("A sheet on the domain's lower side owns no cell there, which a warning says", "[sheet]") {
  const TempFolder folder;
  const Grid grid = cube_grid_of(0, 1, 6);
  for_axes(scene_of(folder, {sheet(shapes::box({0, 0, 0}, {6, 6, 6}))}, grid), {}, [](const GridReader&, const auto& touching) {
    REQUIRE(touching["bodies"][0]["cells"] == 216 - 125);  // the upper sides are cells
    REQUIRE(touching["warnings"].size() == 3);
    for (const auto& warning : touching["warnings"])
      REQUIRE_THAT(warning.template get<std::string>(), Catch::Contains("body0") && Catch::Contains("lower side") && Catch::Contains("36 lines"));
  });
  for_axes(scene_of(folder, {sheet(shapes::box({0.5, 0.5, 0.5}, {6, 6, 6}))}, grid), {},
           [](const GridReader&, const auto& inside) { REQUIRE(inside["warnings"].empty()); });
}

TEST_CASE("Soups of facets full of ties are the sheets that rational arithmetic says, by every engine along every axis", "[sheet]") {
  for_seeds(0, rounds(30), [](auto& random) {
    const int n = random_int(random, 3, 8);
    const Grid grid = shapes::grid_of_ties(random, n);
    expect_exact_sheets({sheet(soup(random, random_int(random, 1, 12), n))}, grid);
  });
}

TEST_CASE("Sheets and solids take precedence over one another like any bodies", "[sheet]") {
  for_seeds(100, rounds(10), [](auto& random) {
    const int n = random_int(random, 4, 8);
    std::vector<Body> bodies;
    for (uint32_t b = 0; b < 5; ++b) {
      const int priority = random_int(random, 0, 2);
      if (b % 2 == 0) bodies.push_back(sheet(soup(random, 5, n), 1 + b % 3, priority));
      else bodies.push_back({shapes::shell_of_ties(random, n), b == 1 ? Rule::kNonzero : Rule::kEvenodd, 1 + b % 3, priority});
    }
    expect_exact_sheets(bodies, shapes::grid_of_ties(random, n));
  });
}

TEST_CASE("Sheets whose crossings miss planes by a rounding, and needles, equal rational arithmetic", "[sheet]") {
  for_seeds(200, 6, [](auto& random) {
    expect_exact_sheets({sheet(shapes::join(shapes::decimal_tetrahedra(random, 3)))}, cube_grid_of(0, 1.1 / 11, 11));
    expect_exact_sheets({sheet(shapes::join({shapes::needle(random), shapes::sheet(random), shapes::needle(random)}))}, cube_grid_of(0, 1, 10));
  });
}

TEST_CASE("The file of sheets does not depend on threads, memory or borders of tiles", "[sheet]") {
  std::mt19937_64 random(300);
  const TempFolder folder;
  const Grid grid = shapes::uneven_grid(41, 22, 40);
  const std::vector<Body> bodies = {
      sheet(soup(random, 25, 20)), {shapes::shell_of_ties(random, 20), Rule::kNonzero, 2}, sheet(shapes::sphere({10, 9, 8}, 7, 3, 0.25), 3)};
  const std::vector<uint32_t> expected = oracle::materials(bodies, grid);
  for_chunks_threads_and_memory(scene_of(folder, bodies, grid), {},
                                [&](const GridReader& reader, const auto&) { REQUIRE(all_cells(reader) == expected); });
}

// Of the background, from cell 0, through faces.
std::vector<bool> flooded(const std::vector<uint32_t>& cells, const Index3& n) {
  std::vector<bool> wet(cells.size(), false);
  std::vector<Index3> stack = {{0, 0, 0}};
  wet[0] = true;
  while (!stack.empty()) {
    const Index3 at = stack.back();
    stack.pop_back();
    for (int d = 0; d < 3; ++d)
      for (const int64_t by : {-1, 1}) {
        Index3 next = at;
        next[d] += by;
        if (next[d] < 0 || next[d] >= n[d]) continue;
        const auto i = static_cast<size_t>((next[2] * n[1] + next[1]) * n[0] + next[0]);
        if (cells[i] == 0 && !wet[i]) wet[i] = true, stack.push_back(next);
      }
  }
  return wet;
}

TEST_CASE("A closed sheet lets no flood through", "[sheet]") {
  const TempFolder folder;
  const Grid grid = cube_grid_of(-5, 0.25, 40);
  for (const Facets& surface : {shapes::sphere({0, 0, 0}, 4, 4, 0x1p-20), shapes::sphere({0.25, 0.125, 0}, 3.7, 0, 0x1p-20),
                                shapes::torus({0, 0, 0}, 3, 1, 30, 20, 0x1p-20), shapes::box({-3, -3, -3}, {3, 3, 3})}) {
    const auto cells = meshed(folder, {sheet(surface)}, grid);
    const auto inside = oracle::winding_numbers(surface, grid, surface[0].vertex[0]);
    const auto wet = flooded(cells, grid.cells());
    size_t dry = 0, owned = 0, leaks = 0;
    for (size_t i = 0; i < cells.size(); ++i) {
      leaks += wet[i] && inside[i] != 0;
      dry += cells[i] == 0 && !wet[i];
      owned += cells[i];
    }
    CHECK(leaks == 0);
    CHECK(dry > 1000);
    CHECK(owned < 12000);  // a skin, not a solid
  }
}

TEST_CASE("A sheet is neither closed nor filled: an open surface is no fault of it", "[sheet]") {
  const TempFolder folder;
  Facets open = shapes::sphere({0, 0, 0}, 4, 3);
  open.resize(open.size() / 2);
  Scene scene = scene_of(folder, {sheet(open)}, cube_grid_of(-5, 0.5, 20));
  const auto report = mesh_quietly(scene, folder / "g.tcell");
  CHECK(report["bodies"][0]["kind"] == "sheet");
  CHECK(report["bodies"][0]["holes"].empty());
  CHECK(report["warnings"].empty());
}

}  // namespace
}  // namespace teracell::mesher
