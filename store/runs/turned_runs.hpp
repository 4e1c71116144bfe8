// Runs along one axis as runs along another one, without expanding cells.
//
// A plane of cells holds the rays of the grid as rows, one below the other. Between a row and the next, cells change where their runs
// differ, and each such cell is a change of its column. So a sweep over the rows takes what the runs of the rows and those of the
// columns are, and nothing for the cells between.
#pragma once
#include <functional>

#include "store/grid/metadata.hpp"
#include "store/runs/named_runs.hpp"

namespace teracell::inline store {

// The columns of a plane, side by side.
class TurnedPlane {
 public:
  NamedRuns column(uint32_t i) const { return {names_.data() + begin_[i] + i, ends_.data() + begin_[i], begin_[i + 1] - begin_[i], 0}; }
  // Brings a column closer, if there is such a column.
  void prefetch(uint32_t i) const {
    if (size_t{i} + 1 >= begin_.size()) return;
    __builtin_prefetch(ends_.data() + begin_[i]);
    __builtin_prefetch(names_.data() + begin_[i] + i);
  }

 private:
  friend class RowSweep;
  std::vector<uint32_t> begin_;  // of each column in ends_; of column i in names_: begin_[i] + i
  std::vector<uint32_t> ends_;
  std::vector<MaterialName> names_;
};
// What a column and a change of it take, in bytes.
inline constexpr size_t kColumnBytes = 8, kChangeBytes = 8;

// The part of a row that one chunk has: it holds the cells [first, end) along the row. Row w has ray `ray0 + w * step`
// of the chunk, for w counted from the chunk's first row.
struct RowStretch {
  const NamedChunk* chunk;
  uint32_t ray0, step;
};

// Turns the rows of a plane. Keeps its memory from plane to plane: each thread has its own.
class RowSweep {
 public:
  // The rows are cut into `stretches` of cells, [ends of the one before, ends[i]). chunk(i, w) has stretch i of row w.
  struct Rows {
    std::vector<uint32_t> ends;
    uint32_t chunk_rows;  // a chunk has the rows from each multiple of this on
    std::function<RowStretch(size_t stretch, uint32_t row)> chunk;
  };
  // Makes the columns [b0, b1) from the rows [w0, w1). After `most` changes it stops at the end of a row. Returns the end of
  // the rows that it took.
  uint32_t turn(const Rows& rows, uint32_t b0, uint32_t b1, uint32_t w0, uint32_t w1, size_t most, TurnedPlane& out);

 private:
  struct Change {
    uint32_t column, row;
    MaterialName name;
  };
  std::vector<Change> changes_;
  std::vector<NamedRuns> last_;
};

}  // namespace teracell::store
