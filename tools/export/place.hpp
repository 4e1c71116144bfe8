// Where the cells of an export lie.
#pragma once
#include "tools/export/format.hpp"

namespace teracell::exports {

inline Index3 size_of(const Box& box) { return {box.hi[0] - box.lo[0], box.hi[1] - box.lo[1], box.hi[2] - box.lo[2]}; }

// The planes between the cells of the box, in order: one more than there are cells. On a coarse level the last cell ends with the grid.
std::vector<double> planes_of(const Export& e, int axis);
double plane_of(const Export& e, int axis, int64_t i);  // one of them

// Cells of one size. On a coarse level the last ones may reach beyond the grid.
struct EqualCells {
  Index3 count;
  Vec3 origin, step;  // the lower corner of the first cell, and the sizes of a cell
  Vec3 centre() const { return {origin[0] + step[0] / 2, origin[1] + step[1] / 2, origin[2] + step[2] / 2}; }  // of the first cell
};
// Throws UsageError, naming the format, if an axis is graded.
EqualCells equal_cells(const Export& e, const char* format);

// A name for a text whose values end with the line.
std::string one_line(const std::string& name);
// Such a line for each material, by a format of its id and its name; nothing where a map made the numbers others.
std::string material_lines(const Export& e, const char* line);

}  // namespace teracell::exports
