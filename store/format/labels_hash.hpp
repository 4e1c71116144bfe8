// One number for what all cells of level 0 are, which depends on nothing else: not on the axis of the rays, the size and order of chunks, how they
// are compressed, or how labels are numbered (FORMAT.md 7.11). The content hash depends on all of these, and on the version of zstd.
//
// It is a sum over cells, modulo the prime p = 2^61 - 1, of a key of the cell's label times gx^x gy^y gz^z. Along a run, whatever its axis,
// powers add up in closed form, so a change of label costs one multiplication. Sums of parts of the grid add up to that of the whole, in any order.
// Rejected: a hash of the runs in order. It depends on the axis, and parts of a grid could not be hashed by themselves.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "store/grid/metadata.hpp"
#include "store/runs/run.hpp"

namespace teracell::inline store {

struct LabelsSum {
  static constexpr uint64_t kMost = (uint64_t{1} << 61) - 2;
  uint64_t value = 0;
  LabelsSum& operator+=(LabelsSum other);
  friend bool operator==(LabelsSum, LabelsSum) = default;
};

// Adds up cells of one grid. Threads may share it. Memory: 8 bytes for each cell of an axis, 6 MB at most.
class LabelsAdder {
 public:
  explicit LabelsAdder(const Metadata& meta);
  // Of a block of level 0 whose first cell is `first`, along u, v, w of the grid's rays.
  LabelsSum sum(const Index3& first, const RayBlock& rays) const;
  // Of the chunk.
  LabelsSum sum(const ChunkKey& key, const RayBlock& rays) const;

 private:
  // Powers of one of the bases: the low bits of an exponent choose from `low`, the others from `high`.
  struct Powers {
    std::vector<uint64_t> low, high;
    uint64_t of_sums = 0;  // 1 / (base - 1), which makes a sum of a difference of powers
    uint64_t at(int64_t exponent) const;
    uint64_t sum(int64_t from, int64_t to) const;  // of the powers from `from` to `to`, half open
  };
  std::array<Powers, 3> powers_;  // along u, v, w
  std::vector<uint64_t> keys_;    // of labels
  uint32_t chunk_rays_, chunk_cells_;
};

// 32 hex digits, of the axes and the sum of all cells.
std::string labels_hash(const Metadata& meta, LabelsSum sum);

}  // namespace teracell::store
