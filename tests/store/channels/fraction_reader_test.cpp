// Shares of materials in boxes of cells.
#include "store/channels/fraction_reader.hpp"

#include "store/read/query.hpp"
#include "store/teracell.h"
#include "tests/support/cube_grid.hpp"
#include "tests/support/meshed.hpp"

namespace teracell {
namespace {

using namespace testing;

struct FractionScene {
  TempFolder folder;
  Grid grid;
  mesher::MeshOptions options;
  FractionScene(int along) {
    grid = {{Axis::uniform(0, 1, 0, 21, 0.5), Axis::graded({0, 1, 3, 4, 4.5, 8, 10, 12, 17, 20}, 0.5), Axis::uniform(-1, 0.5, 0, 37, 0.5)}};
    options.axis = along;
    options.chunk_rays = 4;
    options.fractions = Subdivision{2, 4, 8};
    const std::vector<oracle::Body> bodies = {{shapes::sphere({9, 9, 7}, 6.2, 2), oracle::Rule::kNonzero, 1},
                                              {shapes::box({3.3, 4.1, 2.2}, {14.6, 9.9, 5.7}), oracle::Rule::kNonzero, 2},
                                              {shapes::sphere({14, 12, 9}, 4.4, 2), oracle::Rule::kNonzero, 1}};
    mesh_quietly(scene_of(folder, bodies, grid), folder / "g.tcell", options);
  }
};

TEST_CASE("Shares of a box are those of its cells one by one, sum to one, and are cut at the grid", "[fractions]") {
  std::mt19937_64 random(4);
  for (int along = 0; along < 3; ++along) {
    const FractionScene scene(along);
    const GridReader reader(scene.folder / "g.tcell");
    const FractionReader fractions(reader);
    const Index3 n = reader.meta().grid.cells();
    std::vector<std::vector<double>> all(3, std::vector<double>(static_cast<size_t>(n[0] * n[1] * n[2])));
    for (uint32_t material = 0; material < 3; ++material)
      fractions.read_box<double>({{0, 0, 0}, n}, material, -1, all[material].data(), {1, n[0], n[0] * n[1]});
    size_t mixed = 0;
    for (size_t i = 0; i < all[0].size(); ++i) {
      REQUIRE(all[0][i] + all[1][i] + all[2][i] == 1);
      mixed += all[0][i] != 0 && all[0][i] != 1;
    }
    REQUIRE(mixed > 100);
    for (int round = 0; round < 30; ++round) {
      Box box;
      for (int d = 0; d < 3; ++d) {
        box.lo[d] = random_int(random, -3, static_cast<int>(n[d]));
        box.hi[d] = random_int(random, static_cast<int>(box.lo[d]), static_cast<int>(n[d]) + 3);
      }
      const Index3 size = {box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]};
      const auto material = static_cast<uint32_t>(random_int(random, 0, 2));
      std::vector<float> part(static_cast<size_t>(size[0] * size[1] * size[2]), 9);
      fractions.read_box<float>(box, material, 7, part.data(), {size[1] * size[2], size[2], 1}, random_int(random, 1, 3));
      size_t i = 0;
      for (int64_t x = box.lo[0]; x < box.hi[0]; ++x)
        for (int64_t y = box.lo[1]; y < box.hi[1]; ++y)
          for (int64_t z = box.lo[2]; z < box.hi[2]; ++z, ++i) {
            const bool inside = x >= 0 && y >= 0 && z >= 0 && x < n[0] && y < n[1] && z < n[2];
            REQUIRE(part[i] == (inside ? static_cast<float>(all[material][static_cast<size_t>((z * n[1] + y) * n[0] + x)]) : 7.0f));
          }
    }
  }
}

TEST_CASE("In means a sheet's cell keeps the value of its material, which has no share in it", "[fractions]") {
  std::vector<oracle::Body> bodies = {{shapes::sphere({4, 5, 5}, 3.3, 2)},
                                      {shapes::box({6.3, 1.2, 1.2}, {8.4, 8.7, 8.7}), oracle::Rule::kNonzero, 2}};
  bodies[1].sheet = true;
  const GridReader reader = meshed_reader(bodies, cube_grid_of(0, 1, 10), {.fractions = Subdivision{4, 4, 4}});
  const std::vector<uint32_t> cells = all_cells(reader);
  const double values[] = {1, 5, 40};
  std::vector<double> means(1000);
  FractionReader(reader).read_means(reader.meta().grid.box(0), values, means.data(), {1, 10, 100});
  size_t sheets = 0, mixed = 0;
  for (size_t i = 0; i < cells.size(); ++i) {
    sheets += cells[i] == 2, mixed += means[i] != 1 && means[i] != 5 && means[i] != 40;
    REQUIRE((cells[i] == 2 ? means[i] == 40 : means[i] >= 1 && means[i] <= 5));
  }
  CHECK(sheets > 100);
  CHECK(mixed > 100);
}

TEST_CASE("The C library reads shares into arrays of any strides, and refuses what makes no sense", "[fractions][api]") {
  const FractionScene scene(1);
  tc_grid* grid = nullptr;
  REQUIRE(tc_open((scene.folder / "g.tcell").c_str(), &grid) == TC_OK);
  const std::unique_ptr<tc_grid, void (*)(tc_grid*)> closing(grid, tc_close);
  const GridReader reader(scene.folder / "g.tcell");
  const Box box{{-1, 2, 20}, {8, 7, 40}};
  const int64_t lo[3] = {-1, 2, 20}, hi[3] = {8, 7, 40}, stride[3] = {1, 9, 45}, back[3] = {-1, -9, -45}, none[3] = {0, 9, 45};
  std::vector<double> expected(9 * 5 * 20), found(expected.size());
  FractionReader(reader).read_box<double>(box, 2, 0.5, expected.data(), {1, 9, 45});
  REQUIRE(tc_fractions(grid, 2, lo, hi, found.data(), stride, 0.5, 2) == TC_OK);
  CHECK(found == expected);
  REQUIRE(tc_fractions(grid, 2, lo, hi, &found.back(), back, 0.5, 1) == TC_OK);
  std::ranges::reverse(found);
  CHECK(found == expected);
  CHECK(tc_fractions(grid, 2, hi, lo, nullptr, stride, 0, 1) == TC_OK);  // an empty box
  CHECK(tc_fractions(grid, 9, lo, hi, found.data(), stride, 0, 1) == TC_USAGE);
  CHECK(tc_fractions(grid, 2, lo, hi, nullptr, stride, 0, 1) == TC_USAGE);
  CHECK(tc_fractions(grid, 2, lo, hi, found.data(), none, 0, 1) == TC_USAGE);
  CHECK(tc_fractions(nullptr, 2, lo, hi, found.data(), stride, 0, 1) == TC_USAGE);
}

TEST_CASE("A grid without fractions says so", "[fractions]") {
  const FractionScene scene(0);
  mesher::MeshOptions options = scene.options;
  options.fractions.reset();
  const GridReader reader = meshed_reader({{shapes::box({1, 1, 1}, {5, 5, 5})}}, scene.grid, options);
  REQUIRE_THROWS_WITH(FractionReader(reader), Catch::Contains("memory.tcell: the grid has no fractions"));
}

}  // namespace
}  // namespace teracell
