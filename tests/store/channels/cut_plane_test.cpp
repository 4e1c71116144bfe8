// The plane that stands for a surface in a mixed cell.
#include "store/channels/cut_plane.hpp"

#include "tests/support/cube_grid.hpp"
#include "tests/support/meshed.hpp"

namespace teracell {
namespace {

using namespace testing;

// The part of the unit cube with m . x < a, from lines along z: exact along them, and the midpoint rule across.
double part_below(const Vec3& m, double a) {
  constexpr int kLines = 400;
  double sum = 0;
  for (int i = 0; i < kLines; ++i)
    for (int j = 0; j < kLines; ++j) {
      const double left = a - m[0] * (i + 0.5) / kLines - m[1] * (j + 0.5) / kLines;
      sum += m[2] > 0 ? std::clamp(left / m[2], 0.0, 1.0) : left > 0 ? 1 : 0;
    }
  return sum / (kLines * kLines);
}

TEST_CASE("A plane's constant cuts the share off a cube", "[fractions]") {
  std::mt19937_64 random(3);
  for (int trial = 0; trial < 60; ++trial) {
    Vec3 m{random_in(random, 0, 1), random_in(random, 0, 1), random_in(random, 0.1, 1)};
    if (trial % 5 == 0) m[static_cast<size_t>(trial) / 5 % 2] = trial % 2 == 0 ? 0 : 1e-9;
    const double share = trial % 7 == 0 ? 1e-4 : random_in(random, 0.01, 0.99);
    INFO(m[0] << ' ' << m[1] << ' ' << m[2] << ' ' << share);
    const double a = plane_constant(m, share);
    CHECK(a > 0);
    CHECK(a < m[0] + m[1] + m[2]);
    CHECK(part_below(m, a) == Approx(share).margin(2e-4));
    CHECK(plane_constant(m, 1 - share) == Approx(m[0] + m[1] + m[2] - a));
  }
  CHECK(plane_constant({0, 2, 0}, 0.25) == Approx(0.5));
  CHECK(plane_constant({1, 1, 1}, 0.5) == Approx(1.5));
  CHECK(plane_constant({1, 1, 1}, 1.0 / 6) == Approx(1));
}

TEST_CASE("Planes of a sphere look outwards and lie on it, on uniform and graded axes", "[fractions]") {
  for (const bool graded : {false, true}) {
    Grid grid;
    for (int d = 0; d < 3; ++d) {
      std::vector<double> planes;
      for (int i = 0; i <= 30; ++i) planes.push_back(graded && d == 1 ? i + 2 * std::sin(i / 5.0) : i);
      grid.axis[d] = graded ? Axis::graded(planes, 0.5) : Axis::uniform(0, 1, 0, 30, 0.5);
    }
    const GridReader reader = meshed_reader({{shapes::sphere({15, 15, 15}, 10.3, 5)}}, grid, {.fractions = Subdivision{8, 8, 8}});
    const FractionReader fractions(reader);
    int planes = 0;
    double steepest = 0, farthest = 0;
    fractions.for_each_mixed(grid.box(0), [&](const Index3& first, int64_t length, auto, auto) {
      for (int64_t k = 0; k < length; ++k) {
        Index3 cell = first;
        cell[reader.meta().frame().w] += k;
        std::array<double, 1> share;
        fractions.read_box({cell, {cell[0] + 1, cell[1] + 1, cell[2] + 1}}, 1, 0.0, share.data(), {1, 1, 1});
        const auto plane = cut_plane(fractions, grid, cell, 1);
        REQUIRE(plane);
        const auto other = cut_plane(fractions, grid, cell, 0);
        REQUIRE(other);
        CHECK(other->offset == Approx(-plane->offset).margin(1e-6));
        if (share[0] < 0.1 || share[0] > 0.9) continue;  // of slivers the direction says little
        ++planes;
        // Where the plane is nearest to the sphere's centre.
        const double at_centre = plane->normal[0] * 15 + plane->normal[1] * 15 + plane->normal[2] * 15;
        Vec3 centre;
        for (int d = 0; d < 3; ++d) centre[d] = grid.axis[d].centre(cell[d]) - 15;
        const double r = std::hypot(centre[0], centre[1], centre[2]);
        const double cosine = (plane->normal[0] * centre[0] + plane->normal[1] * centre[1] + plane->normal[2] * centre[2]) / r;
        steepest = std::max(steepest, std::acos(std::min(1.0, cosine)));
        farthest = std::max(farthest, std::abs(plane->offset - at_centre - 10.3));
      }
    });
    CHECK(planes > 500);
    CHECK(steepest < 0.15);  // 8 degrees: half a cell on a sphere of 10 cells is 3 of them
    CHECK(farthest < 0.12);
  }
}

TEST_CASE("What is not mixed has no plane", "[fractions]") {
  const Grid grid = cube_grid_of(0, 1, 4);
  const GridReader reader = meshed_reader({{shapes::box({-1, -1, -1}, {1.5, 5, 5})}}, grid, {.fractions = Subdivision{2, 2, 2}});
  const FractionReader fractions(reader);
  CHECK_FALSE(cut_plane(fractions, grid, {0, 0, 0}, 1));
  CHECK_FALSE(cut_plane(fractions, grid, {3, 3, 3}, 1));
  const auto plane = cut_plane(fractions, grid, {1, 0, 3}, 1);
  REQUIRE(plane);
  CHECK(plane->normal == Vec3{1, 0, 0});
  CHECK(plane->offset == Approx(1.5));
}

}  // namespace
}  // namespace teracell
