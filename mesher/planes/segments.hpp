// The gaps between kept candidates, cut where the largest width of cells changes.
#pragma once
#include <cstdint>
#include <vector>

#include "mesher/planes/widths.hpp"

namespace teracell::mesher {

// A stretch of an axis that is filled with whole cells.
struct Segment {
  double lo, hi;
  double most;        // the largest width of its cells
  bool at_candidate;  // its lower end is one
  double length() const { return hi - lo; }
};

// So many cells, each as wide as any other between them, can have any length from so many times the finest: (n + 1) / n <= growth.
int64_t cells_of_any_length(double growth);

// A segment within a gap, whose cells are narrower than those around it, is a whole number of its widest cells long. `roomy`: no segment is shorter
// than cells_of_any_length() times `finest`, but gaps are; that takes more cells, and always leaves a way to fill them. Cells of a segment may be
// wider than `widths` says only where whole cells no narrower than `finest` can't be less. REQUIRES: `kept` ascends, and has two or more.
std::vector<Segment> cut_into_segments(const std::vector<double>& kept, const Widths& widths, double finest, double growth, bool roomy);

}  // namespace teracell::mesher
