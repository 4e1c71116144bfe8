#include "mesher/scene/placement.hpp"

#include <cmath>

#include <fmt/format.h>

namespace teracell::mesher {

Vec3 moved(const Vec3& p, const SceneBody& body) {
  Vec3 q = transform(body.matrix, p);
  for (double& x : q)
    if (!(std::abs(x) >= 1e-75 && std::abs(x) <= 1e75))  // rare: 0 is allowed, and -0 becomes +0
      x = checked_coordinate(x, fmt::format("{}: a vertex after the transformation of body '{}'", body.mesh.string(), body.name));
  return q;
}

Facet moved(const Facet& facet, const SceneBody& body) {
  return {{moved(facet.vertex[0], body), moved(facet.vertex[1], body), moved(facet.vertex[2], body)}};
}

}  // namespace teracell::mesher
