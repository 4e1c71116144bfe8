// From a file's coordinates to the grid's.
#pragma once
#include "mesher/surface/facet.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell {

// A vertex as the grid sees it. Throws InputError when it leaves what coordinates may be.
Vec3 moved(const Vec3& p, const SceneBody& body);
Facet moved(const Facet& facet, const SceneBody& body);

}  // namespace teracell
