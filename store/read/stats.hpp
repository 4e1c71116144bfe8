// How many cells of each material, or of each label, a box has, how large they are and where they lie. Threads may ask at once.
#pragma once
#include "store/read/reader.hpp"

namespace teracell::inline store {

// Exact counts of level 0 in `box`.
struct CellStats {
  unsigned __int128 cells = 0;
  double volume = 0;
  Box box;  // empty when there is no cell
};
// By label. What the metadata tell of the whole grid is taken from them. Else a chunk that lies in the box as a whole is not decoded: the index says
// enough of it, unless an axis is graded and the cells of a label don't fill a box. Throws UsageError unless the box lies in the grid.
std::vector<CellStats> read_label_stats(const GridReader& reader, const Box& box);
// By material id: the sums of those of the labels, as read_label_stats() gives them.
std::vector<CellStats> stats_by_material(const Metadata& meta, const std::vector<CellStats>& of_labels);
// By material id. Throws what read_label_stats() throws.
std::vector<CellStats> read_stats(const GridReader& reader, const Box& box);

// The box of the cells with one of these labels, on level 0; empty when there are none. No chunk is decoded, and no index page is read if the
// metadata tell.
Box read_box_of(const GridReader& reader, const std::vector<bool>& labels);

}  // namespace teracell::store
