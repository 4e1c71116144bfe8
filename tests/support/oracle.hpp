// The strong oracle: which cells are inside which body (mesher/SCENES.md, "What a cell is"), in exact arithmetic, written so that it can
// be checked by reading rather than to be fast. It shares nothing with the mesher: it casts no ray and scans no facet.
#pragma once
#include "mesher/surface/facet.hpp"
#include "store/grid/grid.hpp"
#include "tests/support/test.hpp"

namespace teracell::oracle {

enum class Rule { kNonzero, kEvenodd };

// A closed surface, or a sheet of any facets; its vertices already transformed. A body of mixed rules is two bodies of one material
// and priority, one after the other: their union is what a body of mixed shells means.
struct Body {
  std::vector<mesher::Facet> facets;
  Rule rule = Rule::kNonzero;
  uint32_t material = 1;
  int64_t priority = 0;
  bool sheet = false;
};

// The material of every cell, 0 where there is no body. C order [z][y][x].
// Throws std::invalid_argument when a body's surface is not closed by its rule: inside has no meaning then.
std::vector<uint32_t> materials(const std::vector<Body>& bodies, const Grid& grid);

// Of every cell, in the same order, whether it is a sheet's: for x, y or z the segment between the cell's planes on that axis,
// through its sample point, all shifted, crosses a facet.
std::vector<bool> sheet_cells(const std::vector<mesher::Facet>& facets, const Grid& grid);

// Between the sample points of `lower` and of its upper neighbour along an axis facets are crossed. Sub-positions are q(k) =
// c + (k / 65536) * (c' - c) with c, c' those two.
struct Interval {
  int axis;
  Index3 lower;
  std::vector<std::pair<uint32_t, int>> steps;  // by facet: from q(k) on the winding number is by `step` another; k from 1 to 65536
};
std::vector<Interval> intervals(const std::vector<mesher::Facet>& facets, const Grid& grid);

// For every cell, in the same order, the winding number of the surface around the cell's (shifted) sample point: +1
// inside a surface whose facets run anticlockwise seen from outside. Facets that disagree in orientation leave the
// parity right, which is all that the even-odd rule needs. `apex` is the cone's point (see oracle.cpp): no result may
// depend on it. REQUIRES: is_closed(facets, kEvenodd), and is_closed(facets, kNonzero) for more than the parity.
std::vector<int> winding_numbers(const std::vector<mesher::Facet>& facets, const Grid& grid, const Vec3& apex);

// kNonzero: every directed edge is used as often as its reverse. kEvenodd: every edge is used an even number of times.
// Zero-length edges are ignored; vertices are equal when their coordinates are.
bool is_closed(const std::vector<mesher::Facet>& facets, Rule rule);

}  // namespace teracell::oracle
