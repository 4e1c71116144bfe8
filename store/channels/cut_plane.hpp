// The plane that stands for a surface within a mixed cell. It is found from the shares of the cell and its neighbours, as Euler codes with
// several materials do (D. L. Youngs, "Time-dependent multi-material flow with large fluid distortion", in: Numerical Methods for Fluid
// Dynamics, 1982), so it is an estimate, whereas the shares are exact.
#pragma once
#include <optional>

#include "store/channels/fraction_reader.hpp"

namespace teracell::inline store {

// The points x with normal · x = offset, in the grid's units. The material lies where normal · x is less.
struct CutPlane {
  Vec3 normal;  // of length 1
  double offset;
};

// The plane of a material in a cell, which has exactly the material's share of the cell on its side; nothing if the cell has none of it, nothing
// else, or neighbours that give no direction. REQUIRES: the cell lies in the grid.
std::optional<CutPlane> cut_plane(const FractionReader& fractions, const Grid& grid, const Index3& cell, uint32_t material);

// The plane constant a, from 0 to m[0] + m[1] + m[2], for which the unit cube has a part of volume `share` where m · x < a (R. Scardovelli and
// S. Zaleski, "Analytical relations connecting linear interfaces and volume fractions in rectangular grids", J. Comput. Phys. 164, 2000).
// REQUIRES: no component of m is negative, not all are 0, and 0 < share < 1. The volume is off by at most 1e-6.
double plane_constant(const Vec3& m, double share);

}  // namespace teracell::store
