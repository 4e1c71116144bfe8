// How thick bodies of cells are along the normals of their surfaces, against what they stand for.
#include "store/read/surface.hpp"

#include <functional>

#include "store/grid/vec3.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

// Cells of what `is_inside` holds at their centres.
GridReader reader_of_shape(const Grid& grid, int ray_axis, const std::function<bool(const Vec3&)>& is_inside) {
  const Index3 n = grid.cells();
  std::vector<Label> cells;
  for (int64_t z = 0; z < n[2]; ++z)
    for (int64_t y = 0; y < n[1]; ++y)
      for (int64_t x = 0; x < n[0]; ++x) cells.push_back(is_inside({grid.axis[0].centre(x), grid.axis[1].centre(y), grid.axis[2].centre(z)}) ? 1 : 0);
  return reader_of(metadata_of(grid, ray_axis, 2), cells);
}

// A cell of the shape, and a point on one of its sides behind which the shape ends; both are met by going outwards.
struct OnSurface {
  Index3 cell;
  Vec3 at;
};
OnSurface surface_towards(const Grid& grid, const std::function<bool(const Vec3&)>& is_inside, const Vec3& inside, const Vec3& direction) {
  const auto cell_of = [&](const Vec3& p) {
    Index3 cell;
    for (int d = 0; d < 3; ++d) cell[d] = grid.axis[d].cell_at(p[d]);
    return cell;
  };
  const auto centre = [&](const Index3& i) { return Vec3{grid.axis[0].centre(i[0]), grid.axis[1].centre(i[1]), grid.axis[2].centre(i[2])}; };
  Index3 last = cell_of(inside);
  for (double t = 0;; t += 1e-3) {
    const Vec3 p = inside + direction * t;
    const Index3 cell = cell_of(p);
    if (!is_inside(centre(cell))) {
      Vec3 at = p;
      for (int d = 0; d < 3; ++d) at[d] = std::clamp(at[d], grid.axis[d].plane(last[d]), grid.axis[d].plane(last[d] + 1));
      return {last, at};
    }
    last = cell;
  }
}

Vec3 random_direction(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Vec3 v = {normal(random), normal(random), normal(random)};
  return v * (1 / length(v));
}

TEST_CASE("A ball is as thick as its diameter wherever its surface is met, and the normal points away from its middle", "[long]") {
  std::mt19937_64 random(40);
  const Grid uniform = cube_grid(0, 60, 60),
             flat = {{Axis::uniform(0, 1, 0, 60, 0.5), Axis::uniform(0, 0.5, 0, 120, 0.5), Axis::uniform(0, 0.75, 0, 80, 0.5)}};
  for (const Grid& grid : {uniform, flat})
    for (const double radius : {8.3, 21.7}) {
      const Vec3 middle = {30.2, 29.6, 30.1};
      const auto ball = [&](const Vec3& p) { return dot(p - middle, p - middle) < radius * radius; };
      const GridReader reader = reader_of_shape(grid, static_cast<int>(random() % 3), ball);
      for (int i = 0; i < 60; ++i) {
        const Vec3 direction = random_direction(random);
        const OnSurface on = surface_towards(grid, ball, middle, direction);
        const auto thick = thickness_at(reader, on.cell, on.at);
        CAPTURE(radius, i);
        REQUIRE(thick);
        CHECK(thick->material == 1);
        CHECK(dot(thick->normal, on.at - middle) > 0.98 * length(on.at - middle));  // 11 degrees
        CHECK(std::abs(length(thick->to - thick->from) - 2 * radius) < 2);
        CHECK(length(thick->from - on.at) < 2);
      }
    }
}

TEST_CASE("A wall is as thick as it is along its normal, however it is turned and however thin it is", "[long]") {
  std::mt19937_64 random(41);
  const Grid grid = cube_grid(0, 64, 64);
  for (const double thickness : {2.0, 3.5, 9.0})
    for (int turn = 0; turn < 12; ++turn) {
      const Vec3 normal = random_direction(random), middle = {32, 32, 32};
      const auto wall = [&](const Vec3& p) { return std::abs(dot(p - middle, normal)) < thickness / 2; };
      const GridReader reader = reader_of_shape(grid, static_cast<int>(random() % 3), wall);
      for (const double sign : {-1.0, 1.0}) {
        // Beside the middle, too.
        const Vec3 along = cross(normal, random_direction(random)), start = middle + along * (5 / length(along));
        const OnSurface on = surface_towards(grid, wall, start, normal * sign);
        const auto thick = thickness_at(reader, on.cell, on.at);
        CAPTURE(thickness, turn, sign);
        REQUIRE(thick);
        CHECK(dot(thick->normal, normal * sign) > (thickness < 3 ? 0.93 : 0.98));  // two cells say less than nine
        CHECK(std::abs(length(thick->to - thick->from) - thickness) < 1.8);
      }
    }
}

TEST_CASE("Sides of a box along the axes are measured exactly, also where the grid ends, and on graded axes") {
  const Grid grid = {
      {Axis::uniform(0, 1, 0, 40, 0.5), Axis::graded({0, 1, 2, 4, 5, 6, 7, 7.5, 8, 10, 12, 13, 14, 15, 20}, 0.5), Axis::uniform(0, 0.5, 0, 40, 0.5)}};
  const auto box = [](const Vec3& p) { return p[0] < 10 && p[1] > 4 && p[1] < 13 && p[2] > 5 && p[2] < 12; };
  const GridReader reader = reader_of_shape(grid, 1, box);
  const auto check = [&](const Index3& cell, const Vec3& at, const Vec3& normal, double expected) {
    const auto thick = thickness_at(reader, cell, at);
    REQUIRE(thick);
    CHECK(dot(thick->normal, normal) == 1.0);
    CHECK(length(thick->to - thick->from) == Approx(expected));
  };
  check({4, 6, 23}, {4.5, 7.25, 12}, {0, 0, 1}, 7);      // above
  check({0, 6, 17}, {0, 7.25, 8.75}, {-1, 0, 0}, 10);    // where the grid ends
  check({9, 6, 17}, {10, 7.25, 8.75}, {1, 0, 0}, 10);    // and from the other side
  check({4, 3, 17}, {4.5, 4, 8.75}, {0, -1, 0}, 9);   // from finer cells to coarser ones
}

TEST_CASE("Within a material there is no surface") {
  const Grid grid = cube_grid(0, 40, 40);
  const GridReader reader = reader_of_shape(grid, 2, [](const Vec3&) { return true; });
  CHECK_FALSE(thickness_at(reader, {20, 20, 20}, {20.5, 20.5, 20.5}));
  CHECK_FALSE(thickness_at(reader, {20, 20, 20}, {20, 20.5, 20.5}));
}

}  // namespace
}  // namespace teracell
