// The planes of axes for which a scene has {"auto": {...}}, from the flat faces and the boxes of its bodies.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "mesher/planes/flat_faces.hpp"
#include "mesher/scene/scene.hpp"
#include "store/grid/report.hpp"

namespace teracell::mesher {

// Of one body, as the grid sees it.
struct ShapeOfBody {
  Vec3 lo, hi;
  const FlatFaces* faces;
};

struct MadePlanes {
  std::array<std::vector<double>, 3> planes;  // of axes that are not made: none
  PlanesReport report;
};

bool makes_planes(const Scene& scene);
// Where the axis begins and ends when the box of all bodies reaches from lo to hi.
std::array<double, 2> domain_of(const AutoPlanes& made, const SceneAxis& axis, double lo, double hi);
// Coordinates that differ by no more are the same flat face.
inline double face_slack(const std::array<double, 2>& domain) { return 1e-9 * (domain[1] - domain[0]); }

// `shapes`: one for each body. lo and hi: the box of all of them. Throws UsageError where the scene's rules can't be met at all.
MadePlanes make_planes(const Scene& scene, const std::vector<ShapeOfBody>& shapes, const Vec3& lo, const Vec3& hi);

}  // namespace teracell::mesher
