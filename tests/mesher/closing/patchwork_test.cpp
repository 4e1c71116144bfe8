// Patches that meet in seams with gaps or with other vertices: the cells are those of the surface that they make up.
#include "tests/support/cube_grid.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/patchworks.hpp"
#include "tests/support/winding.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using shapes::Facets;

std::vector<uint32_t> cells_of(const Facets& facets, const Grid& grid, Fill fill = Fill::kAuto) {
  const TempFolder folder;
  Scene scene = scene_of(folder, {{facets}}, grid);
  scene.bodies[0].fill = fill;
  mesh_quietly(scene, folder / "g.tcell");
  return all_cells(GridReader(folder / "g.tcell"));
}

int64_t filled(const std::vector<uint32_t>& cells) { return static_cast<int64_t>(cells.size()) - std::ranges::count(cells, 0u); }

int64_t differing(const std::vector<uint32_t>& a, const std::vector<uint32_t>& b) {
  int64_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += a[i] != b[i];
  return count;
}

// Cells of the background that are cut off from the grid's first one. `n`: cells along every axis.
int64_t voids(std::vector<uint32_t> cells, int64_t n) {
  std::vector<int64_t> next = {0};
  while (!next.empty()) {
    const int64_t at = next.back();
    next.pop_back();
    if (cells[static_cast<size_t>(at)] != 0) continue;
    cells[static_cast<size_t>(at)] = 1;
    const int64_t x = at % n, y = at / n % n, z = at / (n * n);
    if (x > 0) next.push_back(at - 1);
    if (x + 1 < n) next.push_back(at + 1);
    if (y > 0) next.push_back(at - n);
    if (y + 1 < n) next.push_back(at + n);
    if (z > 0) next.push_back(at - n * n);
    if (z + 1 < n) next.push_back(at + n * n);
  }
  return std::ranges::count(cells, 0u);
}

constexpr int64_t kSphereCells = 64;
const Grid kSphereGrid = cube_grid(-1.07, 1.05, kSphereCells);
const double kStitch = kSphereGrid.axis[0].step() / 4;  // the default

std::vector<uint32_t> cells_of_six(const std::function<Facets(const Facets&, size_t)>& spoil) {
  patchworks::Patches patches = patchworks::cube_sphere({0, 0, 0}, 1, 12);
  for (size_t i = 0; i < patches.size(); ++i) patches[i] = spoil(patches[i], i);
  return cells_of(shapes::join(patches), kSphereGrid);
}

void check_sphere(const std::vector<uint32_t>& cells) {
  static const std::vector<uint32_t> closed = cells_of_six([](const Facets& patch, size_t) { return patch; });
  REQUIRE(filled(closed) == Approx(4.0 / 3 * M_PI / std::pow(kSphereGrid.axis[0].step(), 3)).epsilon(0.01));
  CHECK(differing(cells, closed) * 1000 <= filled(closed));
  CHECK(voids(cells, kSphereCells) == 0);
}

TEST_CASE("A sphere of six patches has the closed one's cells, whatever noise its vertices have") {
  for (const double noise : {1e-9, 1e-7, 1e-4}) {
    INFO("noise " << noise);
    std::mt19937_64 random(1);
    check_sphere(cells_of_six([&](const Facets& patch, size_t) { return patchworks::moved(patch, random, 2 * noise); }));
  }
}

TEST_CASE("A sphere of six patches has the closed one's cells when a seam has more vertices on one side than on the other") {
  for (const double noise : {0.0, 1e-7, 1e-4}) {
    INFO("noise " << noise);
    std::mt19937_64 random(1);
    check_sphere(cells_of_six([&](const Facets& patch, size_t i) {
      const int points = static_cast<int>(i / 2);  // none, one or two on an edge: neighbours never have as many
      return patchworks::moved(points == 0 ? patch : patchworks::split(patch, random, 1, 0, points), random, 2 * noise);
    }));
  }
}

TEST_CASE("A sphere of six patches has the closed one's cells when seams deviate by up to the stitch length") {
  std::mt19937_64 random(1);
  SECTION("by noise") {
    check_sphere(cells_of_six([&](const Facets& patch, size_t) { return patchworks::moved(patch, random, kStitch / 2); }));
  }
  SECTION("by chords") {
    check_sphere(cells_of_six([&](const Facets& patch, size_t i) { return i % 2 == 0 ? patchworks::chords(patch, random, 1, kStitch) : patch; }));
  }
  SECTION("by both") {
    check_sphere(cells_of_six([&](const Facets& patch, size_t i) {
      const Facets finer = i % 2 == 0 ? patchworks::chords(patch, random, 0.7, kStitch / 2) : patchworks::split(patch, random, 0.7, kStitch / 4);
      return patchworks::moved(finer, random, kStitch / 4);
    }));
  }
}

TEST_CASE("Random patchworks have the cells that their winding number is above one half at") {
  constexpr int64_t kCells = 20;
  const Grid grid = cube_grid(-4.1, 4.3, kCells);
  const double stitch = grid.axis[0].step() / 4;
  for (uint64_t seed = 0; seed < rounds(8); ++seed) {
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    const std::vector<Facets> closed = {shapes::sphere({0.1, 0.2, 0.3}, 3.5, 3), shapes::torus({0, 0.1, 0}, 2.5, 1.3, 24, 16),
                                        patchworks::refined(shapes::l_shape({-3, -3, -2}, 6, 2.5, 4), 2),
                                        patchworks::refined(shapes::box({-3.1, -2.9, -2}, {3.3, 3.2, 3.4}), 2)};
    patchworks::Patches patches =
        seed / 4 % 2 == 0 ? patchworks::cut_by_planes(closed[seed % 4], random, 3) : patchworks::cut_by_seeds(closed[seed % 4], random, 6);
    for (Facets& patch : patches) {
      if (random_int(random, 0, 1) == 0) patch = patchworks::chords(patch, random, 0.5, stitch / 2);
      if (random_int(random, 0, 1) == 0) patch = patchworks::split(patch, random, 0.7, stitch / 4, random_int(random, 1, 3));
      patch = patchworks::moved(patch, random, stitch / 4);
    }
    const Facets facets = shapes::join(patches);
    const auto cells = cells_of(facets, grid);
    int64_t different = 0;
    size_t i = 0;
    for (int64_t z = 0; z < kCells; ++z)
      for (int64_t y = 0; y < kCells; ++y)
        for (int64_t x = 0; x < kCells; ++x, ++i)
          different += (cells[i] != 0) != (winding_number(facets, {grid.axis[0].centre(x), grid.axis[1].centre(y), grid.axis[2].centre(z)}) > 0.5);
    CHECK(different * 1000 <= filled(cells));
  }
}

}  // namespace
}  // namespace teracell::mesher
