// The two questions that decide every cell: on which side of an edge a ray passes, and whether a cell's sample point
// lies above a facet. Exact for the doubles given, ties broken by the cell rule: a fast filter, then expansions.
//
// Tie rule (after H. Edelsbrunner, E. Mücke, "Simulation of Simplicity", 1990): all sample points are shifted by
// (e, e^2, e^3), e > 0 infinitesimal, so the first non-zero derivative along x, y, z, in this order, decides.
#pragma once
#include "mesher/surface/facet.hpp"

namespace teracell {

// Sign of (b - a) x (p - a): +1 when a, b, p turn left.
int orient2d(double ax, double ay, double bx, double by, double px, double py);

// Sign of ((b - a) x (c - a)) . (p - a): +1 when p lies on the side that the facet's normal points to.
int orient3d(const Facet& facet, const Vec3& p);

// Sign of component `axis` of the facet's normal.
int normal_sign(const Facet& facet, int axis);

// Whether the ray through (u, v) passes right of (u greater than) the edge lo -> hi in projection.
// REQUIRES: lo_v < hi_v. On the edge counts as right: the shift in u is positive and dwarfs that in v in all frames.
inline bool right_of_edge(double lo_u, double lo_v, double hi_u, double hi_v, double u, double v) {
  return orient2d(lo_u, lo_v, hi_u, hi_v, u, v) <= 0;
}

// Whether the shifted point p lies above the facet's plane, seen along `axis`.
// REQUIRES: normal_sign(facet, axis) != 0.
bool is_above(const Facet& facet, int axis, const Vec3& p);

}  // namespace teracell
