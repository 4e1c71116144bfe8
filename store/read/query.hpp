// Cells out of a .tcell file: a box into memory, the runs of a box, a column. Each question touches only the chunks that
// it needs, one at a time. Threads may ask at once. Slices are in slice.hpp, statistics in stats.hpp.
#pragma once
#include "store/grid/set_value.hpp"
#include "store/read/reader.hpp"

namespace teracell::inline store {

// Writes the values of the cells of `box` (x, y, z; half open) to
// data[(x - lo.x) * stride[0] + (y - lo.y) * stride[1] + (z - lo.z) * stride[2]]. The box may reach outside the grid, or be
// larger than it: cells outside get `outside`.
// T is uint8_t, uint16_t or uint32_t. Threads call `value` at once. Throws UsageError for a level that is not there.
template <class T>
void read_box(const GridReader& reader, int level, const Box& box, const SetValue& value, T outside, T* data, const Index3& stride, int threads = 1);

// Every step-th cell along each axis: the cells first + i * step with 0 <= i < count.
struct Lattice {
  Index3 first{0, 0, 0}, count{0, 0, 0}, step{1, 1, 1};
};
// The same for the cells of a lattice, whose cell i goes to data[i.x * stride[0] + i.y * stride[1] + i.z * stride[2]]. Chunks between its
// cells are not read. REQUIRES: steps are above 0.
template <class T>
void read_lattice(const GridReader& reader, int level, const Lattice& lattice, const SetValue& value, T outside, T* data, const Index3& stride,
                  int threads = 1);

// A run within a box: `length` cells from `start` along the grid's ray axis.
struct BoxRun {
  Index3 start;
  int64_t length;
  const std::vector<Label>* set;
};
// Calls f for the runs of `box`, chunk by chunk; cells are never expanded. A run that passes from one chunk to the next
// along the rays comes in two parts. Throws UsageError unless the box lies in the level.
void for_each_run(const GridReader& reader, int level, const Box& box, const std::function<void(const BoxRun&)>& f);

// The value of all cells of `box`, if they have the same one. REQUIRES: the box is not empty and lies in the level.
std::optional<uint32_t> uniform_value(const GridReader& reader, int level, const Box& box, const SetValue& value);

struct ColumnRun {
  int64_t from, to;
  uint32_t material;
};
// The column of level-0 cells along `axis` through (a, b) of RayFrame::along(axis), as runs of one material each: of its cells `from`
// to `to` (half open), cut to the grid. Throws UsageError unless it lies in the grid.
std::vector<ColumnRun> read_column(const GridReader& reader, int axis, int64_t a, int64_t b, int64_t from = 0, int64_t to = Axis::kMaxCells);

}  // namespace teracell::store
