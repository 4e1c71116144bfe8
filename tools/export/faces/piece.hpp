// A piece of the boundary of a body of cells: the vertices and facets in a block of cells and its margin.
//
// Vertices lie at corners of cells. Where the two cells of a fork (corner.hpp) have the same vertex at both ends of their common edge, four
// facets would have one edge. There each of the two cells has a vertex of its own at the middle of the edge.
#pragma once
#include <vector>

#include "store/grid/grid.hpp"
#include "tools/export/faces/corner.hpp"

namespace teracell::exports::faces {

// Whether cells of a box belong to the body, x fastest.
struct Cells {
  Box box;
  std::vector<uint8_t> in;         // 0 or 1
  std::vector<uint16_t> material;  // of those in the body
};

struct MiddleVertex {
  uint32_t vertex, from, to;  // its number, and those of the edge's ends
};

class Piece {
 public:
  // Finds the vertices. Those at the outer corners of the box are wrong: what they touch is not known. REQUIRES: the box has two
  // cells or more along each axis. The cells are kept by reference.
  void find(const Cells& cells);

  uint32_t vertices() const { return static_cast<uint32_t>(corner_.size()); }
  // The corner of a vertex, by the numbers of the planes that meet there. Vertices are in the order of corners, x fastest.
  Index3 place(uint32_t vertex) const;
  const std::vector<MiddleVertex>& middles() const { return middles_; }

  // Calls f(vertex, neighbour) for the edges of the surface, in the order of vertices. Those at the middle of an edge have none.
  template <class F>
  void for_each_link(F&& f) const;
  // Calls f(cell, vertices) for the facets of the cells of `box`, cell by cell, in the order of Cells. Seen from outside of the body, the
  // three vertices turn counterclockwise.
  template <class F>
  void for_each_facet(const Box& box, F&& f) const;

 private:
  // The polygon of a face.
  struct Outline {
    std::array<uint32_t, 8> vertex;
    uint32_t size = 0, start = 0;  // a fan from vertex `start` has no triangle without area
  };

  uint32_t vertex_of(size_t corner, unsigned cell) const { return first_[corner] + corner_of(pattern_[corner]).vertex[cell]; }
  // Whether the edge that leaves a corner upwards has middle vertices, and the first cell of its fork at this corner.
  bool has_middles(size_t corner, unsigned axis, unsigned& first_cell) const;
  Outline outline(size_t cell_corner, unsigned face) const;
  unsigned exposed(size_t cell) const;

  const Cells* cells_ = nullptr;
  Index3 cell_step_{}, size_{}, step_{};  // of cells; of corners: how many there are between cells, and the distance of neighbours
  std::vector<uint8_t> pattern_;          // by corner: the cells around it
  std::vector<uint32_t> first_;           // by corner with vertices: the first one
  std::vector<uint32_t> corner_;          // by vertex
  std::vector<MiddleVertex> middles_;
};

// ---- Implementation

template <class F>
void Piece::for_each_link(F&& f) const {
  const auto corners = static_cast<int64_t>(pattern_.size());
  for (uint32_t vertex = 0; vertex < corner_.size();) {
    const size_t corner = corner_[vertex];
    const Corner& here = corner_of(pattern_[corner]);
    for (uint8_t i = 0; i < here.link_count; ++i) {
      const Link& link = here.links[i];
      const unsigned axis = link.direction % 3;
      const int64_t other = static_cast<int64_t>(corner) + (link.direction < 3 ? step_[axis] : -step_[axis]);
      if (other < 0 || other >= corners) continue;  // beyond the outer corners
      const uint8_t pattern = pattern_[static_cast<size_t>(other)];
      if (pattern != 0 && pattern != 255) f(vertex + link.vertex, vertex_of(static_cast<size_t>(other), link.cell ^ (1u << axis)));
    }
    while (vertex < corner_.size() && corner_[vertex] == corner) ++vertex;
  }
}

template <class F>
void Piece::for_each_facet(const Box& box, F&& f) const {
  const Index3& lo = cells_->box.lo;
  for (int64_t z = box.lo[2]; z < box.hi[2]; ++z)
    for (int64_t y = box.lo[1]; y < box.hi[1]; ++y) {
      const auto row = static_cast<size_t>((z - lo[2]) * cell_step_[2] + (y - lo[1]) * cell_step_[1] - lo[0]);
      const auto corners = static_cast<size_t>((z - lo[2] - 1) * step_[2] + (y - lo[1] - 1) * step_[1] - lo[0] - 1);
      for (int64_t x = box.lo[0]; x < box.hi[0]; ++x) {
        const size_t cell = row + static_cast<size_t>(x);
        if (cells_->in[cell] == 0) continue;
        const unsigned open = exposed(cell);
        for (unsigned face = 0; open >> face != 0; ++face) {
          if ((open >> face & 1) == 0) continue;
          const Outline o = outline(corners + static_cast<size_t>(x), face);
          for (uint32_t i = 1; i + 1 < o.size; ++i)
            f(cell, std::array{o.vertex[o.start], o.vertex[(o.start + i) % o.size], o.vertex[(o.start + i + 1) % o.size]});
        }
      }
    }
}

}  // namespace teracell::exports::faces
