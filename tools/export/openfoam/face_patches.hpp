// The patches of the surface that lie on the faces between cells, as their links tell: for each row of cells as runs along x. A few layers of
// them are in memory.
#pragma once
#include <limits>

#include "store/channels/link_reader.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports::foam {

// The faces across an axis between neighbouring cells of a row and their upper neighbours.
struct PatchRun {
  int32_t z, y, begin, end;
  uint32_t patch;
};

class FacePatches {
 public:
  // Keeps references to both.
  FacePatches(const Export& e, const LinkReader& links) : e_(e), links_(links), size_(size_of(e.box)) {}
  // REQUIRES: layers are read in ascending order.
  void read(int64_t z);
  // The runs of a row along x, without faces of which no patch is known. Valid until the next read. REQUIRES: z is the layer that was read, or
  // for faces across z the one below it.
  std::span<const PatchRun> row(int axis, int64_t y, int64_t z) const;

 private:
  const Export& e_;
  const LinkReader& links_;
  const Index3 size_;
  int64_t end_ = 0;  // of the layers in memory
  std::array<std::vector<PatchRun>, 3> runs_;
};

// Walks along a row.
class AlongPatches {
 public:
  explicit AlongPatches(std::span<const PatchRun> row) : row_(row) {}
  struct Found {
    uint32_t patch;  // kNoPatch: none is known
    int64_t end;     // it stays so up to here
  };
  // REQUIRES: x never falls.
  Found at(int64_t x) {
    while (!row_.empty() && row_.front().end <= x) row_ = row_.subspan(1);
    if (row_.empty()) return {kNoPatch, std::numeric_limits<int64_t>::max()};
    if (x < row_.front().begin) return {kNoPatch, row_.front().begin};
    return {row_.front().patch, row_.front().end};
  }

 private:
  std::span<const PatchRun> row_;
};

}  // namespace teracell::exports::foam
