// Lines through sample points and the facets that they cross, against each line alone.
#include "mesher/thin/lines.hpp"

#include "mesher/engines/ray.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

Axis graded(std::initializer_list<double> planes, double sample) { return Axis::graded(planes, sample); }

struct Met {
  uint32_t above;
  bool up;
  friend bool operator==(const Met&, const Met&) = default;
};
using Lines = std::map<std::pair<int64_t, int64_t>, Met>;  // by the cells along u and v

// Line by line.
Lines expected(const Grid& grid, const RayFrame& f, const Axis& points, const Facet& facet, const Box& cells) {
  Lines out;
  for (int64_t u = cells.lo[f.u]; u < cells.hi[f.u]; ++u)
    for (int64_t v = cells.lo[f.v]; v < cells.hi[f.v]; ++v) {
      Vec3 p;
      p[f.u] = grid.axis[f.u].centre(u), p[f.v] = grid.axis[f.v].centre(v);
      const int turn = turn_around_ray(facet, f, p[f.u], p[f.v]);
      if (turn == 0) continue;
      uint32_t above = 0;
      for (; above < points.cells(); ++above) {
        p[f.w] = points.centre(above);
        if (is_above(facet, f.w, p)) break;
      }
      out[{u, v}] = {above, turn > 0};
    }
  return out;
}

Lines found(FacetLines& lines, const Facet& facet, const Box& cells) {
  Lines out;
  const RayFrame f = lines.frame();
  uint64_t exact = 0;
  lines.cross(facet, cells, exact, [&](const Index3& first, std::span<const uint32_t> above, bool up) {
    for (size_t i = 0; i < above.size(); ++i) REQUIRE(out.try_emplace({first[f.u] + static_cast<int64_t>(i), first[f.v]}, Met{above[i], up}).second);
  });
  return out;
}

TEST_CASE(
    "A facet's lines, the first sample points above it and the way that it faces are those of each line alone, along every axis, in any part of the grid") {
  std::mt19937_64 random(1);
  const Grid grid{{Axis::uniform(0, 0.5, 0, 12, 0.5), graded({0, 0.25, 1, 1.5, 3, 3.25, 5}, 0.5), Axis::uniform(-1, 0.7, 3, 9, 0.25)}};
  size_t crossed = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const Axis planes = plane_axis(grid.axis[axis]);
    for (const Axis* points : {&grid.axis[axis], &planes}) {
      FacetLines lines(grid, axis, *points);
      REQUIRE(lines.frame().w == axis);
      for (size_t round = 0; round < rounds(150); ++round) {
        Facet facet;
        for (Vec3& v : facet.vertex)
          for (double& x : v) x = round % 3 == 0 ? random_in(random, -1, 7) : random_int(random, -4, 28) * 0.25;
        Box cells = grid.box(0);
        if (round % 2 == 0)
          for (int d = 0; d < 3; ++d) {
            cells.lo[d] = random_int(random, 0, static_cast<int>(cells.hi[d]) - 1);
            cells.hi[d] = random_int(random, static_cast<int>(cells.lo[d]) + 1, static_cast<int>(cells.hi[d]));
          }
        const Lines all = expected(grid, lines.frame(), *points, facet, cells);
        REQUIRE(found(lines, facet, cells) == all);
        crossed += all.size();
      }
    }
  }
  REQUIRE(crossed > 1000);
}

TEST_CASE("A facet that crosses more lines than are looked at together crosses all of them") {
  const Axis line = Axis::uniform(0, 1, 0, 9000, 0.5), few = Axis::uniform(0, 1, 0, 2, 0.5);
  const Grid grid{{line, few, Axis::uniform(0, 1, 0, 5, 0.5)}};
  FacetLines lines(grid, 2, grid.axis[2]);
  const Facet facet{{Vec3{-1, -1, 2}, {20000, -1, 2}, {-1, 40000, 2}}};
  const Lines all = found(lines, facet, grid.box(0));
  REQUIRE(all.size() == 18000);
  REQUIRE(std::ranges::all_of(all, [](const auto& l) { return l.second == Met{2, true}; }));
  const Grid turned{{few, line, grid.axis[2]}};
  FacetLines other(turned, 2, turned.axis[2]);
  REQUIRE(found(other, {{Vec3{-1, -1, 2}, {-1, 20000, 2}, {40000, -1, 2}}}, turned.box(0)).size() == 18000);
}

TEST_CASE("The sample points of an axis of planes are the planes of the axis, bit by bit, and one more than its cells") {
  for (const Axis& axis :
       {Axis::uniform(0.1, 0.3, 0, 50, 0.5), Axis::uniform(-7, 0.1, 12345, 20, 0.25), graded({0.1, 0.3, 0.7, 1.9}, 0.5), graded({-5, 5}, 0)}) {
    const Axis planes = plane_axis(axis);
    REQUIRE(planes.cells() == axis.cells() + 1);
    for (int64_t i = 0; i <= axis.cells(); ++i) REQUIRE(planes.centre(i) == axis.plane(i));
  }
}

}  // namespace
}  // namespace teracell::mesher
