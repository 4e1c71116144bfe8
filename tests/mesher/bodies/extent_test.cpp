// The box and the areas of facets, against adding them up coordinate by coordinate: the same bits on each vector unit.
#include "mesher/bodies/extent.hpp"

#include <random>
#include <vector>

#include "tests/support/catch.hpp"
#include "tests/support/every_way.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

struct Sums {
  Vec3 lo, hi, area;
  std::vector<double> sizes;
  double all;
  bool operator==(const Sums&) const = default;
};

Sums one_by_one(const std::vector<Facet>& facets, double all) {
  Sums out{Vec3{HUGE_VAL, HUGE_VAL, HUGE_VAL}, Vec3{-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, {}, {}, all};
  for (const auto& [p] : facets) {
    Vec3 cross;
    for (int w = 0; w < 3; ++w) {
      const int u = (w + 1) % 3, v = (w + 2) % 3;
      for (const Vec3& q : p) out.lo[w] = std::min(out.lo[w], q[w]), out.hi[w] = std::max(out.hi[w], q[w]);
      cross[w] = (p[1][u] - p[0][u]) * (p[2][v] - p[0][v]) - (p[1][v] - p[0][v]) * (p[2][u] - p[0][u]);
      out.area[w] += std::abs(cross[w]) / 2;
    }
    out.sizes.push_back(std::sqrt((cross[0] * cross[0] + cross[1] * cross[1]) + cross[2] * cross[2]) / 2);
    out.all += out.sizes.back();
  }
  return out;
}

TEST_CASE("The box and the areas of facets are the same bits on each vector unit, in one piece or in many") {
  std::mt19937_64 random(1);
  for (const double scale : {1e-300, 1e-3, 1.0, 1e9}) {
    std::vector<Facet> facets(200);
    std::uniform_real_distribution<double> coordinate(-scale, scale);
    for (Facet& f : facets)
      for (Vec3& v : f.vertex)
        for (double& x : v) x = random() % 8 == 0 ? 0 : coordinate(random);
    const Sums expected = one_by_one(facets, 0.1);
    for (const VectorUnit unit : {VectorUnit::kPlain, VectorUnit::kAvx2, VectorUnit::kAvx512}) {
      const OnVectorUnit on(unit);
      for (const size_t piece : {size_t{1}, size_t{64}, facets.size()}) {
        Extent extent;
        Sums found{{}, {}, {}, {}, 0.1};
        for (size_t first = 0; first < facets.size(); first += piece)
          extent.add(
              std::min(piece, facets.size() - first), [&](size_t i) TERACELL_IN_LINE -> const Facet& { return facets[first + i]; }, found.all,
              [&](size_t, double size) TERACELL_IN_LINE { found.sizes.push_back(size); });
        found.lo = extent.lo, found.hi = extent.hi, found.area = extent.area;
        CHECK((found == expected));
      }
    }
  }
}

}  // namespace
}  // namespace teracell::mesher
