// The generalized winding number of a surface, open or closed, in doubles: its signed solid angle as seen from a point, as a
// share of the whole sphere. A. Jacobson, L. Kavan, O. Sorkine-Hornung, "Robust Inside-Outside Segmentation using
// Generalized Winding Numbers" (2013). Facet by facet, with an arc tangent each.
#pragma once
#include "tests/support/shapes.hpp"

namespace teracell {

double winding_number(const shapes::Facets& facets, const Vec3& point);

}  // namespace teracell
