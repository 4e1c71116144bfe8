// The predicates against integer arithmetic, in which the infinitesimal shift of the cell rule is a number.
#include "mesher/engines/predicates.hpp"

#include "mesher/engines/ray.hpp"
#include "store/grid/grid.hpp"
#include "tests/support/exact.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

using Point = std::array<cpp_int, 3>;

// e = 2^-kShiftBits is small enough: a determinant of coordinates has values from 2^-906 to 2^760.
constexpr int kShiftBits = 1700, kBits = kCoordinateBits + 3 * kShiftBits;

Point exactly(const Vec3& p) { return {in_units(p[0], kBits), in_units(p[1], kBits), in_units(p[2], kBits)}; }
// p + (e, e^2, e^3)
Point shifted(const Vec3& p) {
  Point out = exactly(p);
  for (int d = 0; d < 3; ++d) out[d] += in_units(1, kBits - (d + 1) * kShiftBits);
  return out;
}
int turn(const cpp_int& ax, const cpp_int& ay, const cpp_int& bx, const cpp_int& by, const cpp_int& px, const cpp_int& py) {
  return sign_of((bx - ax) * (py - ay) - (by - ay) * (px - ax));
}

struct ExactPlane {
  Point a, normal;
  explicit ExactPlane(const Facet& f) : a(exactly(f.vertex[0])) {
    const Point b = exactly(f.vertex[1]), c = exactly(f.vertex[2]);
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3, k = (i + 2) % 3;
      normal[i] = (b[j] - a[j]) * (c[k] - a[k]) - (b[k] - a[k]) * (c[j] - a[j]);
    }
  }
  int side(const Point& p) const { return sign_of(normal[0] * (p[0] - a[0]) + normal[1] * (p[1] - a[1]) + normal[2] * (p[2] - a[2])); }
};

// A point on the facet's plane but for a rounding: a combination of its vertices, then often moved to a neighbouring double.
Vec3 point_near(std::mt19937_64& random, const Facet& f) {
  const double s = random_int(random, 0, 4) / 4., t = random_int(random, 0, 4) / 4.;
  Vec3 p;
  for (int d = 0; d < 3; ++d) {
    p[d] = f.vertex[0][d] + s * (f.vertex[1][d] - f.vertex[0][d]) + t * (f.vertex[2][d] - f.vertex[0][d]);
    if (const int by = random_int(random, -2, 2); by == 1 || by == -1) p[d] = std::nextafter(p[d], by * HUGE_VAL);
    if (!is_coordinate(p[d])) p[d] = f.vertex[0][d];
  }
  return p;
}

struct Case {
  Facet facet;
  Vec3 point;
};

// Facets of all kinds, flat, needle-like and without area among them, and points on or beside them.
template <class F>
void for_many_cases(uint64_t seed, size_t count, F&& f) {
  std::mt19937_64 random(seed);
  for (const Coordinates kind : kAllCoordinates)
    for (size_t round = 0; round < rounds(count); ++round) {
      Case c{{{draw_point(random, kind), draw_point(random, kind), draw_point(random, kind)}}, draw_point(random, kind)};
      auto& v = c.facet.vertex;
      if (const int d = random_int(random, 0, 8); d < 3) v[1][d] = v[2][d] = v[0][d];  // across an axis
      if (random_int(random, 0, 7) == 0) v[2] = point_near(random, {{v[0], v[1], v[1]}});
      if (random_int(random, 0, 1) == 0) c.point = point_near(random, c.facet);
      INFO("coordinates of kind " << static_cast<int>(kind) << ", round " << round);
      f(c);
    }
}

TEST_CASE("Three points turn as integer arithmetic says, on a line and a rounding beside it, up to the limits") {
  std::array<int, 3> seen{};
  for_many_cases(1, 400, [&](const Case& c) {
    const auto& [a, b, unused] = c.facet.vertex;
    const Vec3& p = c.point;
    const Point ia = exactly(a), ib = exactly(b), ip = exactly(p);
    const int expected = turn(ia[0], ia[1], ib[0], ib[1], ip[0], ip[1]);
    ++seen[expected + 1];
    REQUIRE(orient2d(a[0], a[1], b[0], b[1], p[0], p[1]) == expected);
    REQUIRE(orient2d(b[0], b[1], p[0], p[1], a[0], a[1]) == expected);
    REQUIRE(orient2d(b[0], b[1], a[0], a[1], p[0], p[1]) == -expected);
  });
  for (const int n : seen) REQUIRE(n > static_cast<int>(rounds(100)));
}

TEST_CASE("A point lies on the side of a facet that integer arithmetic says, on its plane and a rounding beside it, up to the limits") {
  std::array<int, 3> seen{};
  for_many_cases(2, 400, [&](const Case& c) {
    const int expected = ExactPlane(c.facet).side(exactly(c.point));
    ++seen[expected + 1];
    const auto& [v0, v1, v2] = c.facet.vertex;
    REQUIRE(orient3d(c.facet, c.point) == expected);
    REQUIRE(orient3d({{v1, v2, v0}}, c.point) == expected);
    REQUIRE(orient3d({{v1, v0, v2}}, c.point) == -expected);
    REQUIRE(orient3d({{v0, c.point, v2}}, v1) == -expected);  // an odd permutation of all four
  });
  for (const int n : seen) REQUIRE(n > static_cast<int>(rounds(100)));
}

TEST_CASE("A facet's normal has the signs that integer arithmetic says, 0 among them") {
  std::array<int, 3> seen{};
  for_many_cases(3, 200, [&](const Case& c) {
    const ExactPlane plane(c.facet);
    for (int d = 0; d < 3; ++d) {
      const int expected = sign_of(plane.normal[d]);
      ++seen[expected + 1];
      REQUIRE(normal_sign(c.facet, d) == expected);
    }
  });
  for (const int n : seen) REQUIRE(n > static_cast<int>(rounds(100)));
}

TEST_CASE("A point is above a facet when it is after a shift by (e, e^2, e^3), along every axis") {
  int ties = 0;
  for_many_cases(4, 200, [&](const Case& c) {
    const ExactPlane plane(c.facet);
    const Point p = shifted(c.point);
    ties += plane.side(exactly(c.point)) == 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (plane.normal[axis] == 0) continue;
      REQUIRE(plane.side(p) != 0);
      REQUIRE(is_above(c.facet, axis, c.point) == (plane.side(p) == sign_of(plane.normal[axis])));
      const auto& [v0, v1, v2] = c.facet.vertex;
      REQUIRE(is_above({{v0, v2, v1}}, axis, c.point) == is_above(c.facet, axis, c.point));  // whichever way it faces
    }
  });
  REQUIRE(ties > static_cast<int>(rounds(100)));
}

TEST_CASE("A ray on an edge passes right of it, as the shifted ray does, along every axis") {
  int ties = 0;
  for_many_cases(5, 200, [&](const Case& c) {
    const Point ip = shifted(c.point);
    for (int axis = 0; axis < 3; ++axis) {
      const RayFrame f = RayFrame::along(axis);
      Vec3 lo = c.facet.vertex[0], hi = c.facet.vertex[1];
      if (lo[f.v] == hi[f.v]) continue;
      if (lo[f.v] > hi[f.v]) std::swap(lo, hi);
      const Point il = exactly(lo), ih = exactly(hi);
      ties += orient2d(lo[f.u], lo[f.v], hi[f.u], hi[f.v], c.point[f.u], c.point[f.v]) == 0;
      const int side = turn(il[f.u], il[f.v], ih[f.u], ih[f.v], ip[f.u], ip[f.v]);
      REQUIRE(side != 0);
      REQUIRE(right_of_edge(lo[f.u], lo[f.v], hi[f.u], hi[f.v], c.point[f.u], c.point[f.v]) == (side < 0));
    }
  });
  REQUIRE(ties > static_cast<int>(rounds(100)));
}

TEST_CASE("A facet winds around a ray when the shifted ray passes through its projection, through edges and vertices too") {
  std::array<int, 3> seen{};
  int through_vertices = 0;
  const auto check = [&](const Facet& facet, const Vec3& p) {
    const Point ip = shifted(p), a = exactly(facet.vertex[0]), b = exactly(facet.vertex[1]), c = exactly(facet.vertex[2]);
    for (int axis = 0; axis < 3; ++axis) {
      const RayFrame f = RayFrame::along(axis);
      const int s = turn(a[f.u], a[f.v], b[f.u], b[f.v], ip[f.u], ip[f.v]);
      const bool inside =
          s != 0 && turn(b[f.u], b[f.v], c[f.u], c[f.v], ip[f.u], ip[f.v]) == s && turn(c[f.u], c[f.v], a[f.u], a[f.v], ip[f.u], ip[f.v]) == s;
      ++seen[(inside ? s : 0) + 1];
      REQUIRE(turn_around_ray(facet, f, p[f.u], p[f.v]) == (inside ? s : 0));
    }
  };
  for_many_cases(6, 120, [&](const Case& c) {
    check(c.facet, c.point);
    check(c.facet, c.facet.vertex[0]);
    const RayFrame z = RayFrame::along(2);
    through_vertices += turn_around_ray(c.facet, z, c.facet.vertex[0][z.u], c.facet.vertex[0][z.v]) != 0;
  });
  for (const int n : seen) REQUIRE(n > static_cast<int>(rounds(100)));
  REQUIRE(through_vertices > static_cast<int>(rounds(50)));
}

TEST_CASE("No answer changes when all is moved or scaled by a power of two that rounds nothing") {
  std::mt19937_64 random(7);
  for (size_t round = 0; round < rounds(500); ++round) {
    Facet facet;
    for (Vec3& v : facet.vertex) v = draw_point(random, Coordinates::kLattice);
    const Vec3 p = round % 2 == 0 ? draw_point(random, Coordinates::kLattice) : facet.vertex[round % 3];
    for (const double by : {0x1p20, -0x1p40, 0x1p48})
      for (const double scale : {1., 0x1p-200, 0x1p150}) {
        const auto moved = [&](Vec3 q) {
          for (double& x : q) x = (x + by) * scale;
          return q;
        };
        const Facet other{{moved(facet.vertex[0]), moved(facet.vertex[1]), moved(facet.vertex[2])}};
        REQUIRE(orient3d(other, moved(p)) == orient3d(facet, p));
        for (int axis = 0; axis < 3; ++axis) {
          REQUIRE(normal_sign(other, axis) == normal_sign(facet, axis));
          if (normal_sign(facet, axis) != 0) REQUIRE(is_above(other, axis, moved(p)) == is_above(facet, axis, p));
        }
      }
  }
}

}  // namespace
}  // namespace teracell::mesher
