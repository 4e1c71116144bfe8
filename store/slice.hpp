// Cells out of a .tcell file: a box into memory, the runs of a box, the rows of a slice, statistics. Each touches only
// the chunks that it needs, a chunk at a time; level L derives what is not stored. All are safe on a shared reader.
#pragma once
#include <functional>
#include <span>

#include "store/reader.hpp"

namespace teracell {

// What a set of labels becomes in an array or a picture.
using SetValue = std::function<uint32_t(const std::vector<Label>&)>;
// The material of highest precedence.
SetValue strongest_material(const Metadata& meta);
// The ids of all its materials, ascending.
std::vector<uint32_t> materials_of(const Metadata& meta, const std::vector<Label>& set);

// Arrays of material ids have a byte a cell, or two past 256 materials, little endian.
inline bool wide_labels(const Metadata& meta) { return meta.materials.size() > 256; }
// Appends ids so to bytes of any type.
template <class Out>
void put_labels(Out& out, std::span<const uint16_t> ids, bool wide) {
  for (const uint16_t id : ids) {
    out.push_back(static_cast<typename Out::value_type>(id));
    if (wide) out.push_back(static_cast<typename Out::value_type>(id >> 8));
  }
}

// Writes the values of the cells of `box` (x, y, z; half open; may reach outside the grid, or be larger than it) to
// data[(x - lo.x) * stride[0] + (y - lo.y) * stride[1] + (z - lo.z) * stride[2]]; cells outside the grid get `outside`.
// T is uint8_t, uint16_t or uint32_t. Throws UsageError for a level that is not there.
template <class T>
void read_box(const GridReader& reader, int level, const Box& box, const SetValue& value, T outside, T* data, const Index3& stride);

// A run within a box: `length` cells from `start` along the grid's ray axis.
struct BoxRun {
  Index3 start;
  int64_t length;
  const std::vector<Label>* set;
};
// Calls f for the runs of `box`, chunk by chunk; cells are never expanded. A run that passes from one chunk to the next
// along the rays comes in two parts. Throws UsageError, like read_stats(), unless the box lies in the level.
void for_each_run(const GridReader& reader, int level, const Box& box, const std::function<void(const BoxRun&)>& f);

// The runs of the column of level-0 cells along `axis` through (a, b) of Frame::along(axis), joined where the material
// continues.
struct ColumnRun {
  int64_t from, to;
  uint32_t material;
};
std::vector<ColumnRun> read_column(const GridReader& reader, int axis, int64_t a, int64_t b);

// Exact counts of level 0 in `box`.
struct MaterialStats {
  unsigned __int128 cells = 0;
  double volume = 0;
  Box box;  // empty when there is no cell
};
// By material id. Chunks that lie in the box are counted from their summaries; where an axis is graded, those whose labels
// fill boxes.
std::vector<MaterialStats> read_stats(const GridReader& reader, const Box& box);

// A rectangle of a slice across `axis` at `index`, in cells of `level`: u in [u0, u1), v in [v0, v1) of Frame::along(axis).
struct SliceView {
  int axis = 2;
  int64_t index = 0;
  int level = 0;
  int64_t u0 = 0, v0 = 0, u1 = 0, v1 = 0;
};
// The whole slice. Throws UsageError when level or index is out of range, naming the range.
SliceView whole_slice(const Metadata& meta, int axis, int64_t index, int level);
void check_view(const Metadata& meta, const SliceView& view);

// Calls row(v, values) for every row of the view, from the top (v1 - 1) down or from v0 up: with all u1 - u0 values of the
// row, or, where these are many, with parts of it, one after another. Values are below 65536. Memory: about `held` cells of two
// bytes, and as much a thread as a chunk and 1024 columns of it take. Decodes on `threads` threads.
using RowSink = std::function<void(int64_t v, std::span<const uint16_t> values)>;
inline constexpr int64_t kHeldCells = int64_t{1} << 26;
void for_each_row(const GridReader& reader, const SliceView& view, const SetValue& value, bool top_down, int threads, const RowSink& row,
                  int64_t held = kHeldCells);

}  // namespace teracell
