// How planes are written, and where their pictures lie.
#include "server/render/plane.hpp"

#include "server/render/camera.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;
using Words = std::map<std::string, std::string, std::less<>>;

PlaneView view_of(const Grid& grid, const Words& words) {
  const auto text = [&](std::string_view name) -> const std::string* {
    const auto it = words.find(name);
    return it == words.end() ? nullptr : &it->second;
  };
  return parse_plane_view(text, grid, "--");
}

Grid plain_grid() { return {{Axis::uniform(0, 0.5, 0, 20, 0.5), Axis::uniform(-3, 1, 0, 8, 0.5), Axis::uniform(2, 0.25, 0, 16, 0.5)}}; }

Vec3 point(const PlaneView& view, double i, double j) { return view.corner + view.right * i + view.up * j; }
bool near(const Vec3& a, const Vec3& b) { return norm(a - b) < 1e-9; }

TEST_CASE("A plane across an axis has the pixels of the slice, as it is seen from above x and z and from below y", "[render]") {
  const Grid grid = plain_grid();
  const PlaneView z = view_of(grid, {{"plane", "0,0,1,3"}, {"pixels", "20"}});
  CHECK(z.corner == Vec3{0, -3, 3});
  CHECK(z.right == Vec3{0.5, 0, 0});
  CHECK(z.up == Vec3{0, 0.5, 0});
  CHECK(std::pair(z.i1, z.j1) == std::pair<int64_t, int64_t>(20, 16));
  const PlaneView x = view_of(grid, {{"plane", "2,0,0,5"}, {"pixel", "0.25"}});
  CHECK(x.corner == Vec3{2.5, -3, 2});
  CHECK(x.right == Vec3{0, 0.25, 0});
  CHECK(x.up == Vec3{0, 0, 0.25});
  const PlaneView y = view_of(grid, {{"plane", "0,-1,0,-1"}, {"pixel", "1"}});
  CHECK(y.corner == Vec3{0, 1, 2});
  CHECK(y.right == Vec3{1, 0, 0});
  CHECK(y.up == Vec3{0, 0, 1});
}

TEST_CASE("A normal and an offset, two angles and a point, and three points say the same plane", "[render]") {
  const Grid grid = plain_grid();
  // 45 degrees round z, and as far above the plane of x and y as (1, 1, sqrt 2) is.
  const PlaneView by_angles = view_of(grid, {{"plane", "45,45,5,1,4"}});
  const double root = std::sqrt(2.0), offset = 5 + 1 + root * 4;
  const PlaneView by_normal = view_of(grid, {{"plane", fmt::format("1,1,{},{}", root, offset)}});
  const Vec3 p = point(by_normal, 10, 10), q = point(by_normal, 400, 30), r = point(by_normal, 50, 300);
  const PlaneView by_points =
      view_of(grid, {{"plane", fmt::format("{},{},{},{},{},{},{},{},{}", p[0], p[1], p[2], q[0], q[1], q[2], r[0], r[1], r[2])}});
  for (const PlaneView& view : {by_angles, by_points}) {
    CHECK(near(view.corner, by_normal.corner));
    CHECK(near(view.right, by_normal.right));
    CHECK(near(view.up, by_normal.up));
  }
  CHECK(view_of(grid, {{"plane", "90,0,1,0,3"}}).right == view_of(grid, {{"plane", "0,1,0,0"}}).right);  // right angles are exact
}

TEST_CASE("All of a plane that lies in the grid is in its picture, and no side of it is farther away than a pixel", "[render][long]") {
  const Grid grid = plain_grid();
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> share(0, 1);
  for (int n = 0; n < 200; ++n) {
    const Vec3 middle{10 * share(random), -3 + 8 * share(random), 2 + 4 * share(random)};
    const PlaneView view =
        view_of(grid, {{"plane", fmt::format("{},{},{},{},{}", 360 * share(random), 180 * share(random) - 90, middle[0], middle[1], middle[2])}});
    REQUIRE(std::max(view.i1, view.j1) == 1024);
    // The distance between neighbours is the same to the right and upwards, and these are at right angles.
    REQUIRE(norm(view.right) == Approx(norm(view.up)));
    REQUIRE(std::abs(dot(view.right, view.up)) < 1e-12);
    int64_t outside_picture = 0;
    for (int64_t j = -20; j < 1044; j += 2)
      for (int64_t i = -20; i < 1044; i += 2) {
        if (i == 0 && j >= 0 && j < view.j1) i += (view.i1 + 1) / 2 * 2;  // over the picture: whatever is in it may be there
        bool inside = true;
        for (size_t d = 0; d < 3; ++d) inside &= view.middle(d, i, j) >= grid.axis[d].min() && view.middle(d, i, j) < grid.axis[d].max();
        outside_picture += inside;
      }
    REQUIRE(outside_picture == 0);
  }
}

TEST_CASE("A part of a plane lies around its centre, with pixels as large as they are asked for", "[render]") {
  const Grid grid = plain_grid();
  const PlaneView view = view_of(grid, {{"plane", "0,0,1,3"}, {"centre", "4,1,77"}, {"pixel", "0.125"}, {"size", "300,200"}});
  CHECK(near(point(view, 150, 100), {4, 1, 3}));
  CHECK(norm(view.right) == 0.125);
  CHECK(std::pair(view.i1, view.j1) == std::pair<int64_t, int64_t>(300, 200));
  const PlaneView fitted = view_of(grid, {{"plane", "0,0,1,3"}, {"size", "100,50"}});
  CHECK(near(point(fitted, 50, 25), {5, 1, 3}));
  CHECK(norm(fitted.up) == 0.16);  // eight lengths in fifty pixels
}

TEST_CASE("The level of a plane is the highest whose cells are no wider than a pixel", "[render]") {
  const Grid grid = plain_grid();  // whose widest cells are 1
  const auto level = [&](const char* pixel) { return view_of(grid, {{"plane", "0,0,1,3"}, {"pixel", pixel}}).level; };
  CHECK(level("0.001") == 0);
  CHECK(level("1.999") == 0);
  CHECK(level("2") == 1);
  CHECK(level("4.5") == 2);
  CHECK(view_of(grid, {{"plane", "0,0,1,3"}, {"pixel", "8"}, {"level", "1"}}).level == 1);
}

TEST_CASE("What is no plane, or misses the grid, is refused with what was expected", "[render]") {
  const Grid grid = plain_grid();
  const auto refused = [&](const Words& words, const std::string& part) { CHECK_THROWS_WITH(view_of(grid, words), Catch::Contains(part)); };
  refused({{"plane", "1,2,3"}}, "--plane: expected 4, 5 or 9 numbers");
  refused({{"plane", "0,0,0,1"}}, "--plane: expected 4, 5 or 9 numbers");
  refused({{"plane", "0,0,0,1,1,1,2,2,2"}}, "not on one line");
  refused({{"plane", "1,0,nan,1"}}, "--plane: expected");
  refused({{"plane", "1,0,0,11"}}, "--plane: expected a plane that meets the grid, found '1,0,0,11'");
  refused({{"plane", "0,91,1,1,1"}}, "elevation");
  refused({{"plane", "1,0,0,5"}, {"pixel", "0"}}, "--pixel: expected a length above 0");
  refused({{"plane", "1,0,0,5"}, {"pixel", "1e-9"}}, "--pixel: expected a length with which");
  refused({{"plane", "1,0,0,5"}, {"size", "0,4"}}, "--size: expected width and height");
  refused({{"plane", "1,0,0,5"}, {"size", "4,4"}, {"pixels", "4"}}, "--pixels: expected it without --size");
  refused({{"plane", "1,0,0,5"}, {"level", "9"}}, "--level: expected 0 to 5");
}

}  // namespace
}  // namespace teracell::server
