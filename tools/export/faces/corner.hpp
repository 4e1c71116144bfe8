// How the boundary of a body of cells passes through a corner of the grid, so that it is a surface without forks.
//
// Where two cells touch along an edge alone, four faces meet there. Each cell then keeps its own two: the surface is that of cells which
// are a trifle smaller than they are. So the faces that a cell has at a corner hang together, and belong to one vertex. A corner has as many
// vertices as sheets of the surface pass through it, at most four, all in the same place.
#pragma once
#include <array>
#include <cstdint>

namespace teracell::exports::faces {

// Eight cells meet at a corner: cell dx + 2 dy + 4 dz, where d is 1 for the upper one. Directions are those of the edges that leave the
// corner: x, y and z upwards are 0, 1 and 2, downwards 3, 4 and 5.
struct Link {
  uint8_t vertex, direction;
  uint8_t cell;  // one whose faces have this edge: at the edge's other end, its vertex is the neighbour
};

struct Corner {
  uint8_t vertices = 0;
  std::array<uint8_t, 8> vertex{};  // by cell of the body that has a face here
  uint8_t forks = 0;                // bit `direction`: two cells touch along this edge alone
  uint8_t link_count = 0;
  std::array<Link, 12> links{};     // by vertex, then by direction
};

extern const std::array<Corner, 256> kCorners;
// Bit c of `cells` says whether cell c belongs to the body.
inline const Corner& corner_of(uint8_t cells) { return kCorners[cells]; }

}  // namespace teracell::exports::faces
