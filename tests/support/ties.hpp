// Surfaces and axes that are hard to decide: sample points exactly on facets, a rounding beside them, and facets whose
// slope doubles lose. For grids of cells about 1 wide that begin about 0.
#pragma once
#include "store/grid/grid.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/shapes.hpp"

namespace teracell::shapes {

// On multiples of 1/2 and 1/4 within about [-1, n + 1], where sample points lie too; one in three inside out.
Facets shell_of_ties(std::mt19937_64& random, int n);
// Of some n cells; centres and planes are on the same lattice.
Axis axis_of_ties(std::mt19937_64& random, int n);
Grid grid_of_ties(std::mt19937_64& random, int n);
// One to `most` such shells of any rule, material from 1 to 3, and priority.
std::vector<oracle::Body> bodies_of_ties(std::mt19937_64& random, int n, int most);

// Tetrahedra with corners at 0.05, 0.15 ... 1.05, which no double holds: what would be a tie misses by a rounding.
std::vector<Facets> decimal_tetrahedra(std::mt19937_64& random, int count);
// Of each material from 1 on, a body of two.
std::vector<oracle::Body> decimal_bodies(std::mt19937_64& random, uint32_t materials);

// Tetrahedra within [-7, 18], 2^-50 to 2^-20 wide: one 9 long, and half of a face of [0.5, 9.5]^3 whose facets are all but
// vertical.
Facets needle(std::mt19937_64& random);
Facets sheet(std::mt19937_64& random);

// Two axes of other steps and sample points than 1 and 0.5, and a graded one, each of which begins about 0.
Grid uneven_grid(int64_t nx, int64_t ny, size_t planes_of_z);

}  // namespace teracell::shapes
