// The gaps between kept candidates, cut where the largest width of cells changes.
#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "mesher/planes/widths.hpp"

namespace teracell::mesher {

// A stretch of an axis that is filled with whole cells.
struct Segment {
  double lo, hi;
  double most;          // the largest width of its cells
  size_t from, to;      // its ends: places are numbered from the axis's lower end
  bool at_candidate;    // its lower end is one
  bool in_short_gap;    // the gap is shorter than cells_of_any_length() times `finest`
  bool breaks_width;    // whole cells no narrower than `finest` are wider than `widths` says
  bool across_middle;   // it ends as far beyond the middle of a symmetric axis as it begins before it
  double length() const { return hi - lo; }
};

// Segments from one place to another, by ascending `to`. Each way from the first place to the last one is a way to cut the axis.
struct Cuts {
  size_t places = 0;
  std::vector<Segment> segments;
};

enum class Cutting {
  kChoice,  // a cell may lie across a change of width: there are several places to choose from where one is
  kRoomy    // no segment is shorter than cells_of_any_length() times `finest`, but gaps are: more cells, and always a way to fill them
};

// So many cells, each as wide as any other between them, can have any length from so many times the finest: (n + 1) / n <= growth.
int64_t cells_of_any_length(double growth);

// `middle`: of a symmetric axis, whose lower half alone is cut; a gap in its middle has segments across it. REQUIRES: `kept` ascends, and has two
// or more.
Cuts cut_into_segments(const std::vector<double>& kept, const Widths& widths, double finest, double growth, Cutting how,
                       const std::optional<double>& middle);

}  // namespace teracell::mesher
