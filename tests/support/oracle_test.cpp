// The oracle against what can be known without it: boxes by hand, partitions, analytic volumes, and a second way to
// the winding number.
#include <boost/multiprecision/cpp_int.hpp>

#include "tests/support/cube_grid.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/shapes.hpp"

namespace teracell {
namespace {

using oracle::Body;
using oracle::Rule;
using shapes::Facets;
using Rational = boost::multiprecision::cpp_rational;

// Cells of width 1 whose centres are the integers 0 .. n - 1.
Grid integer_grid(int64_t n) { return cube_grid_of(-0.5, 1, n); }

// Planes that widen: centres are not on any common lattice of few bits.
Grid graded_grid(int64_t n, double widening) {
  std::vector<double> planes = {-0.5};
  for (double width = 0.3; static_cast<int64_t>(planes.size()) <= n; width *= widening) {
    planes.push_back(planes.back() + width);
  }
  const Axis axis = Axis::graded(planes, 0.25);
  return {{axis, axis, axis}};
}

std::vector<uint32_t> cells(const Facets& facets, const Grid& grid, Rule rule = Rule::kNonzero) { return oracle::materials({{facets, rule}}, grid); }

// The cells with lo <= index < hi on every axis.
std::vector<uint32_t> index_box(const Grid& grid, const Index3& lo, const Index3& hi) {
  const Index3 n = grid.cells();
  std::vector<uint32_t> expected;
  for (int64_t z = 0; z < n[2]; ++z) {
    for (int64_t y = 0; y < n[1]; ++y) {
      for (int64_t x = 0; x < n[0]; ++x) {
        expected.push_back(x >= lo[0] && x < hi[0] && y >= lo[1] && y < hi[1] && z >= lo[2] && z < hi[2]);
      }
    }
  }
  return expected;
}

double filled_volume(const std::vector<uint32_t>& material, double cell_volume) {
  return static_cast<double>(std::count_if(material.begin(), material.end(), [](uint32_t m) { return m != 0; })) * cell_volume;
}

// A second way to the winding number: crossings of the ray from the shifted point along +x, in rationals. In the yz
// plane the point is (y + e^2, z + e^3), so an edge's side test is a polynomial in e with the edge's own vector as its
// higher coefficients; likewise the facet's plane test.
int lexicographic_sign(const std::vector<Rational>& coefficients) {
  for (const Rational& c : coefficients) {
    if (c != 0) return c > 0 ? 1 : -1;
  }
  return 0;
}

int winding_along_x(const Facets& facets, const Vec3& p) {
  int winding = 0;
  const Rational px(p[0]), py(p[1]), pz(p[2]);
  for (const mesher::Facet& f : facets) {
    std::array<std::array<Rational, 3>, 3> v;  // relative to the point
    for (int i = 0; i < 3; ++i) {
      v[i] = {Rational(f.vertex[i][0]) - px, Rational(f.vertex[i][1]) - py, Rational(f.vertex[i][2]) - pz};
    }
    std::array<int, 3> side;
    for (int i = 0; i < 3; ++i) {
      const auto &a = v[i], &b = v[(i + 1) % 3];
      const Rational dy = b[1] - a[1], dz = b[2] - a[2];
      // cross(b - a, (e^2, e^3) - a)
      side[i] = lexicographic_sign({a[1] * dz - a[2] * dy, -dz, dy});
    }
    if (side[0] == 0 || side[0] != side[1] || side[1] != side[2]) continue;
    std::array<Rational, 3> n;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      n[i] = (v[1][j] - v[0][j]) * (v[2][k] - v[0][k]) - (v[1][k] - v[0][k]) * (v[2][j] - v[0][j]);
    }
    // n . ((e, e^2, e^3) - a) has the sign of -n_x when the plane lies ahead along +x.
    const Rational at_point = -(n[0] * v[0][0] + n[1] * v[0][1] + n[2] * v[0][2]);
    if (lexicographic_sign({at_point, n[0], n[1], n[2]}) == -lexicographic_sign({n[0]})) winding += side[0];
  }
  return winding;
}

TEST_CASE("a box owns the cells of its lower faces and not those of its upper ones", "[oracle]") {
  const Grid grid = integer_grid(8);
  CHECK(cells(shapes::box({2, 3, 1}, {5, 6, 7}), grid) == index_box(grid, {2, 3, 1}, {5, 6, 7}));
  CHECK(cells(shapes::box({2.5, 2.5, 2.5}, {4.5, 4.5, 4.5}), grid) == index_box(grid, {3, 3, 3}, {5, 5, 5}));
}

TEST_CASE("the diagonals of a box's faces decide no cell", "[oracle]") {
  const Grid grid = integer_grid(6);
  const Facets box = shapes::box({1, 1, 1}, {4, 4, 4});
  for (int first = 0; first < 3; ++first) {
    Facets turned = box;  // the same facets from another vertex, in another order
    for (mesher::Facet& f : turned) std::rotate(f.vertex.begin(), f.vertex.begin() + first, f.vertex.end());
    std::reverse(turned.begin(), turned.end());
    CHECK(cells(turned, grid) == index_box(grid, {1, 1, 1}, {4, 4, 4}));
  }
}

TEST_CASE("bodies that share a plane neither overlap nor leave a gap", "[oracle]") {
  const Grid grid = integer_grid(8);
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 lo = {1, 1, 1}, hi = {7, 7, 7}, middle_hi = hi, middle_lo = lo;
    middle_hi[axis] = middle_lo[axis] = 4;
    const auto low = cells(shapes::box(lo, middle_hi), grid), high = cells(shapes::box(middle_lo, hi), grid);
    const auto whole = cells(shapes::box(lo, hi), grid);
    for (size_t i = 0; i < whole.size(); ++i) REQUIRE(low[i] + high[i] == whole[i]);
  }
}

TEST_CASE("tetrahedra that fill a box hold each of its cells once", "[oracle]") {
  for (const Grid& grid : {integer_grid(9), graded_grid(9, 1.1)}) {
    const Vec3 lo = {1, 1, 1}, hi = {7, 7, 7};
    std::vector<uint32_t> sum(9 * 9 * 9, 0);
    for (const Facets& part : shapes::box_in_tetrahedra(lo, hi)) {
      const auto inside = cells(part, grid);
      for (size_t i = 0; i < sum.size(); ++i) sum[i] += inside[i];
    }
    CHECK(sum == cells(shapes::box(lo, hi), grid));
  }
}

TEST_CASE("a flipped surface holds the same cells by either rule", "[oracle]") {
  const Grid grid = integer_grid(12);
  const Facets sphere = shapes::sphere({5, 6, 5}, 4, 2, 1), torus = shapes::torus({5, 5, 5}, 3, 1.5, 9, 7, 0.5);
  for (const Facets& shape : {sphere, torus, shapes::l_shape({1, 2, 3}, 8, 3, 4)}) {
    const auto inside = cells(shape, grid);
    CHECK(cells(shapes::flip(shape), grid) == inside);
    CHECK(cells(shape, grid, Rule::kEvenodd) == inside);
    CHECK(cells(shapes::flip(shape), grid, Rule::kEvenodd) == inside);
  }
}

TEST_CASE("one flipped facet changes nothing by the even-odd rule and is refused by nonzero", "[oracle]") {
  const Grid grid = integer_grid(8);
  Facets box = shapes::box({1, 2, 3}, {5, 6, 7});
  const auto inside = cells(box, grid);
  std::swap(box[3].vertex[0], box[3].vertex[1]);
  CHECK(cells(box, grid, Rule::kEvenodd) == inside);
  CHECK_THROWS_AS(cells(box, grid), std::invalid_argument);
}

TEST_CASE("overlapping shells are a union by nonzero and exclude each other by even-odd", "[oracle]") {
  const Grid grid = integer_grid(10);
  const Facets first = shapes::box({1, 1, 1}, {6, 6, 6}), second = shapes::box({3, 3, 3}, {9, 9, 9});
  const auto a = cells(first, grid), b = cells(second, grid);
  const auto either = cells(shapes::join({first, second}), grid);
  const auto one = cells(shapes::join({first, second}), grid, Rule::kEvenodd);
  for (size_t i = 0; i < a.size(); ++i) {
    REQUIRE(either[i] == (a[i] | b[i]));
    REQUIRE(one[i] == (a[i] ^ b[i]));
  }
}

TEST_CASE("an inner shell turned inside out is a cavity by nonzero", "[oracle]") {
  const Grid grid = integer_grid(10);
  const Facets outer = shapes::box({1, 1, 1}, {9, 9, 9}), inner = shapes::box({3, 3, 3}, {6, 6, 6});
  const auto hollow = cells(shapes::join({outer, shapes::flip(inner)}), grid);
  CHECK(hollow == cells(shapes::join({outer, inner}), grid, Rule::kEvenodd));
  CHECK(filled_volume(hollow, 1) == 8 * 8 * 8 - 3 * 3 * 3);
}

TEST_CASE("the highest priority wins, and the later body at equal priority", "[oracle]") {
  const Grid grid = integer_grid(6);
  const Facets box = shapes::box({0, 0, 0}, {6, 6, 6});
  const auto top = [&](int64_t p1, int64_t p2, int64_t p3) {
    return oracle::materials({{box, Rule::kNonzero, 1, p1}, {box, Rule::kNonzero, 2, p2}, {box, Rule::kEvenodd, 3, p3}}, grid)[0];
  };
  CHECK(top(0, 0, 0) == 3);
  CHECK(top(1, 0, 0) == 1);
  CHECK(top(-5, -3, -4) == 2);
  CHECK(top(7, 7, 6) == 2);
}

TEST_CASE("volumes of cells converge to the surface's volume", "[oracle]") {
  const auto error = [](const Facets& facets, int64_t n) {
    const Grid grid = cube_grid(-1, 1, n);
    return std::abs(filled_volume(cells(facets, grid), std::pow(2.0 / static_cast<double>(n), 3)) / shapes::volume(facets) - 1);
  };
  const Facets sphere = shapes::sphere({0.03, -0.02, 0.01}, 0.9, 3);
  CHECK(error(sphere, 6) < 0.1);
  CHECK(error(sphere, 12) < 0.02);
  CHECK(error(sphere, 24) < 0.004);
  const Facets torus = shapes::torus({0.03, -0.02, 0.01}, 0.6, 0.3, 24, 12);
  CHECK(error(torus, 12) < 0.07);
  CHECK(error(torus, 24) < 0.03);
  if (!kSanitized) CHECK(error(torus, 48) < 0.01);
  CHECK(error(shapes::prism({0.03, -0.02, 0.01}, 0.9, 6, 1.5), 24) < 0.03);
}

TEST_CASE("volumes of surfaces converge to the analytic ones", "[oracle]") {
  const double pi = std::numbers::pi;
  CHECK(shapes::volume(shapes::sphere({1, 2, 3}, 2, 3)) == Approx(32 * pi / 3).epsilon(0.03));
  CHECK(shapes::volume(shapes::sphere({1, 2, 3}, 2, 5)) == Approx(32 * pi / 3).epsilon(0.002));
  CHECK(shapes::volume(shapes::torus({1, 2, 3}, 0.6, 0.3, 200, 100)) == Approx(0.108 * pi * pi).epsilon(0.002));
  CHECK(shapes::volume(shapes::prism({1, 2, 3}, 2, 4, 3)) == Approx(24));
}

TEST_CASE("the winding number does not depend on the apex nor on how it is found", "[oracle]") {
  std::mt19937_64 random(7);
  for (const Grid& grid : {integer_grid(7), cube_grid(-0.1, 6.3, 7), graded_grid(7, 1.25)}) {
    std::vector<Facets> shells = shapes::random_tetrahedra(random, 12, 0, 6, 1);
    shells.push_back(shapes::flip(shapes::box({1, 2, 1}, {4, 5, 6})));
    shells.push_back(shapes::sphere({3, 3, 3}, 2, 1, 0.5));
    const Facets soup = shapes::join(shells);
    REQUIRE(oracle::is_closed(soup, Rule::kNonzero));

    const auto winding = oracle::winding_numbers(soup, grid, soup[0].vertex[0]);
    CHECK(winding == oracle::winding_numbers(soup, grid, {0, 0, 0}));
    if (kSanitized) break;
    CHECK(winding == oracle::winding_numbers(soup, grid, {0.1, -7.3, 1e-3}));
    size_t cell = 0;
    for (int64_t z = 0; z < 7; ++z) {
      for (int64_t y = 0; y < 7; ++y) {
        for (int64_t x = 0; x < 7; ++x, ++cell) {
          const Vec3 p = {grid.axis[0].centre(x), grid.axis[1].centre(y), grid.axis[2].centre(z)};
          REQUIRE(winding[cell] == winding_along_x(soup, p));
        }
      }
    }
  }
}

TEST_CASE("coordinates at both ends of the allowed range are exact", "[oracle]") {
  const Grid grid = integer_grid(5);
  CHECK(cells(shapes::box({-1e75, 1e-75, -1e-75}, {1e75, 3, 2}), grid) == index_box(grid, {0, 1, 0}, {5, 3, 2}));
  // One unit in the last place on either side of a centre.
  CHECK(cells(shapes::box({std::nextafter(1.0, 2.0), 1, 1}, {std::nextafter(3.0, 4.0), 3, 3}), grid) == index_box(grid, {2, 1, 1}, {4, 3, 3}));
}

TEST_CASE("degenerate facets keep a surface closed and hold nothing", "[oracle]") {
  const Grid grid = integer_grid(6);
  CHECK(cells(shapes::tetrahedron({0, 0, 2}, {4, 0, 2}, {0, 4, 2}, {3, 3, 2}), grid) == index_box(grid, {}, {}));
  const Facets crumpled = shapes::sphere({2, 2, 2}, 1.2, 3, 1);  // most facets collapse to edges and points
  CHECK(oracle::is_closed(crumpled, Rule::kNonzero));
  CHECK(cells(crumpled, grid) == cells(crumpled, grid, Rule::kEvenodd));
  Facets open = shapes::box({0, 0, 0}, {1, 1, 1});
  open.pop_back();
  CHECK_FALSE(oracle::is_closed(open, Rule::kNonzero));
  CHECK_FALSE(oracle::is_closed(open, Rule::kEvenodd));
}

TEST_CASE("every shape is closed and faces outward", "[oracle]") {
  CHECK(shapes::volume(shapes::box({0, 1, 2}, {2, 4, 6})) == 24);
  CHECK(shapes::volume(shapes::l_shape({1, 1, 1}, 4, 1, 2)) == 14);
  CHECK(shapes::volume(shapes::tetrahedron({0, 0, 0}, {0, 6, 0}, {6, 0, 0}, {0, 0, 1})) == 6);
  for (const double lattice : {0.0, 0.25}) {
    for (const Facets& shape :
         {shapes::sphere({1, 2, 3}, 2, 2, lattice), shapes::torus({1, 2, 3}, 3, 1, 8, 6, lattice), shapes::prism({1, 2, 3}, 2, 5, 3, lattice)}) {
      CHECK(oracle::is_closed(shape, Rule::kNonzero));
      CHECK(shapes::volume(shape) > 0);
    }
  }
}

}  // namespace
}  // namespace teracell
