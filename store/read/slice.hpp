// Slices of any size, row by row. Threads may ask at once.
#pragma once
#include "store/grid/set_value.hpp"
#include "store/read/reader.hpp"

namespace teracell::inline store {

// A rectangle of a slice across `axis` at `index`, in cells of `level`: u in [u0, u1), v in [v0, v1) of RayFrame::along(axis).
struct SliceView {
  int axis = 2;
  int64_t index = 0;
  int level = 0;
  int64_t u0 = 0, v0 = 0, u1 = 0, v1 = 0;
};
// The whole slice. Throws UsageError, with the range that is allowed, when the level or the index is outside it.
SliceView whole_slice(const Metadata& meta, int axis, int64_t index, int level);
// Throws UsageError unless the view is not empty and lies in the grid.
void check_view(const Metadata& meta, const SliceView& view);

// Calls row(v, values) for every row of the view, from the top (v1 - 1) down or from v0 up. `values` are all u1 - u0 values
// of the row, or, where these are many, parts of it one after another. They are below 65536. Decodes on `threads` threads.
// Memory: about `held` cells of two bytes, and per thread what a chunk and 1024 of its columns take.
using RowSink = std::function<void(int64_t v, std::span<const uint16_t> values)>;
inline constexpr int64_t kHeldCells = int64_t{1} << 26;
// `unreadable`: the value of cells that can't be read; without it, they are an error.
void for_each_row(const GridReader& reader, const SliceView& view, const SetValue& value, bool top_down, int threads, const RowSink& row,
                  int64_t held = kHeldCells, std::optional<uint16_t> unreadable = {});

}  // namespace teracell::store
