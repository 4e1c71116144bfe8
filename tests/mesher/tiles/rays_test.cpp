// Rays that a facet may meet, found for one or for many at once.
#include "mesher/tiles/rays.hpp"

#include "tests/mesher/tiles/tile_grids.hpp"
#include "tests/support/every_way.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

bool equal(const RayRange& a, const RayRange& b) { return a.u0 == b.u0 && a.u1 == b.u1 && a.v0 == b.v0 && a.v1 == b.v1; }

// Some coordinates are sample points or borders of the grid, or lie far outside.
Vec3 point(std::mt19937_64& random, const Metadata& meta) {
  Vec3 out;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = meta.grid.axis[d];
    const double width = axis.max() - axis.min();
    switch (random() % 6) {
      case 0: out[d] = axis.centre(random_int(random, 0, static_cast<int>(axis.cells()) - 1)); break;
      case 1: out[d] = random() % 2 == 0 ? axis.min() : axis.max(); break;
      case 2: out[d] = random_in(random, -1, 1) * 1e70; break;
      default: out[d] = axis.min() + random_in(random, -0.2, 1.2) * width;
    }
  }
  return out;
}

TEST_CASE("The rays of many facets are those of each, on every vector unit") {
  std::mt19937_64 random(8);
  std::vector<Metadata> grids = tile_grids();
  for (int i = 0; i < 20; ++i) {
    const auto axis = [&] {
      return Axis::uniform(random_in(random, -9, 9), random_in(random, 1e-3, 3), random_int(random, 0, 50), random_int(random, 1, 999), 0.5);
    };
    grids.push_back(tile_grid(i % 3, axis(), axis(), axis(), 16));
  }
  for (const Metadata& meta : grids)
    for (const VectorUnit unit : {VectorUnit::kPlain, VectorUnit::kAvx2, VectorUnit::kAvx512}) {
      const OnVectorUnit on(unit);
      for (const auto& widened : {std::vector<uint8_t>{}, {3}}) {
        const GridRays rays(meta, widened);
        std::vector<Facet> facets(random() % 50);
        std::vector<Vec3> points;
        for (Facet& f : facets)
          for (Vec3& v : f.vertex) points.push_back(v = point(random, meta));
        std::vector<RayRange> found(facets.size()), of_points(points.size());
        rays.ranges_of(
            facets.size(), [&](size_t i) TERACELL_IN_LINE -> const Facet& { return facets[i]; }, [](size_t) { return 0U; }, found.data());
        rays.ranges_of(points, of_points.data());
        for (size_t i = 0; i < facets.size(); ++i) {
          REQUIRE(equal(found[i], rays.range_of(facets[i], 0)));
          REQUIRE(equal(found[i], rays.range_of(of_points[3 * i], of_points[3 * i + 1], of_points[3 * i + 2], 0)));
        }
      }
    }
}

}  // namespace
}  // namespace teracell::mesher
