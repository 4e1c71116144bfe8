// The two predicates that decide every cell: on which side of an edge a ray passes, and whether a cell's sample point lies
// above a facet. They are exact for the doubles given: a fast filter comes first, then expansions.
//
// Ties are broken by a rule after H. Edelsbrunner, E. Mücke, "Simulation of Simplicity" (1990): all sample points are shifted by
// (e, e^2, e^3) with an infinitesimal e > 0. So the first nonzero derivative along x, y, z, in this order, decides.
#pragma once
#include "mesher/surface/facet.hpp"

namespace teracell::mesher {

// The unit roundoff of doubles.
inline constexpr double kRoundoff = 0x1p-53;

// (b - a) x (p - a) where doubles tell its sign for sure (Shewchuk's bound for the first stage of orient2d); elsewhere 0.
inline double sure_turn(double ax, double ay, double bx, double by, double px, double py) {
  constexpr double kBound = (3 + 16 * kRoundoff) * kRoundoff;
  const double left = (bx - ax) * (py - ay), right = (by - ay) * (px - ax);
  const double turn = left - right;
  return std::abs(turn) > kBound * (std::abs(left) + std::abs(right)) ? turn : 0;
}

// The sign of (b - a) x (p - a): +1 when a, b, p turn left.
int orient2d(double ax, double ay, double bx, double by, double px, double py);

// The sign of ((b - a) x (c - a)) . (p - a): +1 when p lies on the side to which the facet's normal points.
int orient3d(const Facet& facet, const Vec3& p);

// The sign of component `axis` of the facet's normal.
int normal_sign(const Facet& facet, int axis);

// Whether the ray through (u, v) passes on the right, at greater u, of the edge lo -> hi in projection. A ray on the edge passes
// on the right: in all frames the shift in u is positive, and that in v is infinitely smaller. REQUIRES: lo_v < hi_v.
inline bool right_of_edge(double lo_u, double lo_v, double hi_u, double hi_v, double u, double v) {
  return orient2d(lo_u, lo_v, hi_u, hi_v, u, v) <= 0;
}

// Whether the point p, shifted by the tie rule, lies above the facet's plane, that is, further along `axis`.
// REQUIRES: normal_sign(facet, axis) != 0.
bool is_above(const Facet& facet, int axis, const Vec3& p);

}  // namespace teracell::mesher
