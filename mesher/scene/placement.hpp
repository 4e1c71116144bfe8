// Transforms a body's vertices from the coordinates of its file to those of the grid.
#pragma once
#include "mesher/scene/scene.hpp"
#include "mesher/surface/facet.hpp"

namespace teracell::mesher {

// A vertex in the coordinates of the grid. Throws InputError when it leaves the range of coordinates (is_coordinate).
Vec3 moved(const Vec3& p, const SceneBody& body);
Facet moved(const Facet& facet, const SceneBody& body);

}  // namespace teracell::mesher
