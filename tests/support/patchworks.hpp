// Open surfaces as programs export them: closed ones cut into patches, each with vertices of its own along its seams.
#pragma once
#include "tests/support/shapes.hpp"

namespace teracell::patchworks {

using shapes::Facets;
using Patches = std::vector<Facets>;

// A sphere as six patches, the faces of a cube of n x n squares each; closed when they are joined.
Patches cube_sphere(const Vec3& centre, double radius, int n);
// Every facet cut in four, so many times.
Facets refined(Facets facets, int levels);
// Each facet goes to the nearest of so many random facets.
Patches cut_by_seeds(const Facets& facets, std::mt19937_64& random, size_t patches);
// By random planes through the middle of the surface's box, or near it.
Patches cut_by_planes(const Facets& facets, std::mt19937_64& random, int planes);

// What happens to a patch's seam, the edges that its own facets don't match. `share`: of the vertices or edges, at random.
Facets moved(Facets patch, std::mt19937_64& random, double by);                                   // each vertex by up to that
Facets split(const Facets& patch, std::mt19937_64& random, double share, double off, int points = 1);  // edges, at points up to that far off them
Facets chords(Facets patch, std::mt19937_64& random, double share, double off);                   // past vertices up to that far off

}  // namespace teracell::patchworks
