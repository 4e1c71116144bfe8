// Surfaces and axes that are hard to decide: sample points exactly on facets, a rounding beside them, and facets whose
// slope doubles lose. For grids of cells about 1 wide that begin about 0.
#pragma once
#include "store/grid/grid.hpp"
#include "tests/support/shapes.hpp"

namespace teracell::shapes {

// On multiples of 1/2 and 1/4 within about [-1, n + 1], where sample points lie too; one in three inside out.
Facets shell_of_ties(std::mt19937_64& random, int n);
// Of some n cells; centres and planes are on the same lattice.
Axis axis_of_ties(std::mt19937_64& random, int n);

// Tetrahedra with corners at 0.05, 0.15 ... 1.05, which no double holds: what would be a tie misses by a rounding.
std::vector<Facets> decimal_tetrahedra(std::mt19937_64& random, int count);

// Tetrahedra within [-7, 18], 2^-50 to 2^-20 wide: one 9 long, and half of a face of [0.5, 9.5]^3 whose facets are all but
// vertical.
Facets needle(std::mt19937_64& random);
Facets sheet(std::mt19937_64& random);

}  // namespace teracell::shapes
