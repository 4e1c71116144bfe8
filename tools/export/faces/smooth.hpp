// Where the vertices of a piece lie, smoothed or not.
#pragma once
#include "tools/export/faces/piece.hpp"

namespace teracell::exports::faces {

// Planes of the box that is exported, for the corners of a piece: of plane i, along each axis, planes[i - first]. Beyond the sides of the
// exported box, the side is repeated.
struct Planes {
  Index3 first;
  std::array<std::vector<double>, 3> at;
};

// A step moves each vertex towards the mean of its neighbours, or away from it. Vertices reach as far as this times half a cell: so the
// surface passes between the centres of the same cells as before, and meshing it gives the same cells. Nor does it leave the exported box.
inline constexpr double kReach = 15.0 / 16;

// The vertices on their planes, after `rounds` of smoothing: two steps each. What a vertex is moved by in one step reaches its neighbours
// in the next, so places are right 2 * rounds corners away from the outer ones.
//
// A round is that of Gabriel Taubin, "A Signal Processing Approach to Fair Surface Design", 1995: a step that shrinks the surface and one
// that expands it again. The reach is from Sarah Gibson, "Constrained Elastic Surface Nets", 1998, who shrinks alone and so
// loses volume.
void place_vertices(const Piece& piece, const Planes& planes, int rounds, std::vector<Vec3>& out);

}  // namespace teracell::exports::faces
