// How far caps are to be trusted: the surface's own winding number against the cells.
#include "mesher/closing/trust.hpp"

#include "tests/support/cube_grid.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/winding.hpp"

namespace teracell::mesher {
namespace {

using shapes::Facets;

std::pair<Vec3, Vec3> box_of(const Facets& facets) {
  Vec3 lo = facets[0].vertex[0], hi = lo;
  for (const Facet& f : facets)
    for (const Vec3& v : f.vertex)
      for (int d = 0; d < 3; ++d) lo[d] = std::min(lo[d], v[d]), hi[d] = std::max(hi[d], v[d]);
  return {lo, hi};
}

// A surface and what closes it.
struct Closed {
  Facets surface, closing;
  void feed(TrustCheck& check) const {
    for (const Facet& f : surface) check.add_surface(f);
    for (const Facet& f : closing) check.add_closing(f);
  }
  std::vector<TrustPoint> points(const Grid& grid, uint64_t count) const {
    const auto [lo, hi] = box_of(surface);
    const auto drawn = draw_trust_points(lo, hi, grid, count);
    TrustCheck check(drawn, lo, hi);
    feed(check);
    return check.points();
  }
  Trust trust(const Grid& grid, int threads = 1) const {
    const auto [lo, hi] = box_of(surface);
    return try_points(draw_trust_points(lo, hi, grid, 4096), lo, hi, threads, [&](TrustCheck& check) { feed(check); });
  }
};

// The lower half of a unit sphere, and a cone over its rim down to `depth`.
Closed bowl(double depth) {
  Closed out;
  for (const Facet& f : shapes::sphere({0, 0, 0}, 1, 4))
    if (f.vertex[0][2] + f.vertex[1][2] + f.vertex[2][2] < 0) out.surface.push_back(f);
  for (const Facet& f : out.surface)
    for (int i = 0; i < 3; ++i) {
      const Vec3 &a = f.vertex[i], &b = f.vertex[(i + 1) % 3];
      if (a[2] == 0 && b[2] == 0) out.closing.push_back({{b, a, {0, 0, -depth}}});
    }
  return out;
}

TEST_CASE("A sphere with a small hole is trusted") {
  Facets sphere = shapes::sphere({0.1, 0.2, 0.3}, 2, 4);
  Closed c{sphere, {}};
  c.surface.erase(c.surface.begin() + 100, c.surface.begin() + 104);
  c.closing.assign(sphere.begin() + 100, sphere.begin() + 104);
  const Trust trust = c.trust(cube_grid(-3, 3, 150));
  CHECK(trust.points == 4096);
  CHECK(trust.disagree == 0);
  CHECK(trust_warning(trust, "ball").empty());
}

TEST_CASE("A bowl whose cap dents in is doubted in the dent, and nowhere else") {
  // Where the rim is seen under less than half of a sphere the bowl is seen under more: all of the half ball is inside.
  const Trust trust = bowl(0.5).trust(cube_grid(-1.2, 1.2, 240));
  const double cone = std::numbers::pi * 0.5 / 3, box = 4;
  CHECK(static_cast<double>(trust.disagree) / static_cast<double>(trust.points) == Approx(cone / box).epsilon(0.05));
  // From a point on the axis at depth d the rim is a cone of solid angle 2 pi (1 - d / sqrt(1 + d^2)).
  CHECK(trust.clearest == Approx(0.5 / std::sqrt(1.25) / 2).epsilon(0.1));
  CHECK(trust.at[2] < -0.35);
  CHECK(std::hypot(trust.at[0], trust.at[1]) < 0.15);
  CHECK(trust.lo[2] >= -0.5);
  CHECK(trust.lo[0] >= -1);
  CHECK(trust.hi[0] <= 1);
  CHECK(trust.hi[2] <= 0);
  CHECK_THAT(trust_warning(trust, "bowl"), Catch::Contains("'bowl'") && Catch::Contains("4096") && Catch::Contains(std::to_string(trust.disagree)));
  CHECK(bowl(0).trust(cube_grid(-1.2, 1.2, 240)).disagree == 0);
}

TEST_CASE("Winding numbers are the sums of solid angles, inside is what rational arithmetic says") {
  std::mt19937_64 random(1);
  const Grid grid = cube_grid(-0.47, 9.53, 20);
  for (int round = 0; round < 8; ++round) {
    Closed c{shapes::join({shapes::join(shapes::random_tetrahedra(random, 6, 0, 9, 0.375)), shapes::torus({4, 5, 4}, 3, 1.3, 9, 7)}), {}};
    for (int i = 0; i < 9; ++i) {
      const size_t gone = static_cast<size_t>(testing::random_int(random, 0, static_cast<int>(c.surface.size()) - 1));
      c.closing.push_back(c.surface[gone]);
      c.surface.erase(c.surface.begin() + static_cast<int64_t>(gone));
    }
    const auto cells = oracle::materials({{shapes::join({c.surface, c.closing})}}, grid);
    for (const TrustPoint& p : c.points(grid, 500)) {
      CHECK(p.winding == Approx(winding_number(c.surface, p.at)).margin(1e-3));  // it is taken 1e-6 of the box beside
      const auto cell = [&](int d) { return grid.axis[d].cell_at(p.at[d]); };
      CHECK(p.inside == (cells[static_cast<size_t>((cell(2) * 20 + cell(1)) * 20 + cell(0))] != 0));
    }
  }
}

TEST_CASE("Sample points on a closed surface are no doubt, on its edges and vertices neither") {
  const Grid grid = cube_grid(-0.5, 7.5, 8);
  const Facets box = shapes::box({1, 2, 1}, {5, 5, 6});
  for (const Facets& facets :
       {box, shapes::flip(box), shapes::join({box, box}), shapes::sphere({3, 3, 3}, 2, 2, 1), shapes::l_shape({0, 1, 2}, 6, 2, 3)})
    CHECK(Closed{facets, {}}.trust(grid).disagree == 0);
}

TEST_CASE("Doubts are the same to the last bit for any number of threads", "[threads]") {
  const Closed c = bowl(0.4);
  const Grid grid = cube_grid(-1.2, 1.2, 100);
  const Trust one = c.trust(grid);
  REQUIRE(one.disagree > 0);
  for (const int threads : {2, 3, 7}) {
    const Trust more = c.trust(grid, threads);
    CHECK(more.points == one.points);
    CHECK(more.disagree == one.disagree);
    CHECK(more.clearest == one.clearest);
    CHECK(more.at == one.at);
    CHECK(more.lo == one.lo);
    CHECK(more.hi == one.hi);
  }
}

TEST_CASE("Points are sample points of cells in the body's box, as far as the grid reaches") {
  const Grid grid{{Axis::uniform(0, 0.5, 0, 20, 0.25), Axis::uniform(-5, 0.1, 0, 100, 0.5), Axis::graded({0, 1, 3, 6, 10, 15}, 0.5)}};
  const auto points = draw_trust_points({-100, 1, 2}, {3, 2, 100}, grid, 1000);
  REQUIRE(points.size() == 1000);
  for (const Vec3& p : points)
    for (int d = 0; d < 3; ++d) CHECK(p[d] == grid.axis[d].centre(grid.axis[d].cell_at(p[d])));
  const auto [lo, hi] = box_of({{points[0], points[1], points[2]}});
  CHECK(lo[0] >= 0);
  CHECK(hi[0] <= 3.5);
  CHECK(lo[1] >= 0.9);
  CHECK(hi[1] <= 2.1);
  CHECK(draw_trust_points({20, 1, 2}, {30, 2, 3}, grid, 1000).empty());
  CHECK(trust_points(1, 1) == 4096);
  CHECK(trust_points(1, 512) == 4096);
  CHECK(trust_points(1, 1 << 17) == 16);
  CHECK(trust_points(1 << 20, 1) == 128);
  CHECK(trust_points(uint64_t{1} << 28, 1) == 0);
}

TEST_CASE("Two points in a thousand may disagree without a warning") {
  Trust t;
  t.points = 4096;
  t.disagree = 8;
  CHECK(trust_warning(t, "a").empty());
  t.disagree = 9;
  CHECK_THAT(trust_warning(t, "a"), Catch::Contains("9 (0.2 %)"));
}

}  // namespace
}  // namespace teracell::mesher
