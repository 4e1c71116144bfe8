// The differences of two grids as a grid: its labels are the changes, and label 0 stands for what is the same in both.
//
// What labels there are is known when all cells have been compared. So the blocks of rays in which something differs wait on disk, in any
// order, and are then written in the order of the tree, with the levels above. What is the same takes no space there.
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "store/base/spill.hpp"
#include "store/grid/metadata.hpp"
#include "store/runs/chunk_codec.hpp"
#include "store/runs/run.hpp"

namespace teracell::inline store {

// One thread puts; then threads may take.
class SpilledChanges {
 public:
  // For rays of the grid that `meta` describes.
  SpilledChanges(const std::filesystem::path& folder, const Metadata& meta);
  // The rays of chunk (cu, cv) of level 0, `length` cells from `first` on, as a chunk's frame. REQUIRES: what is put of a chunk ascends.
  void put(uint32_t cu, uint32_t cv, uint32_t first, uint32_t length, std::span<const uint8_t> frame);
  // The same rays from end to end; label_of[] has the label for each number in the frames. `decoder` is the thread's own.
  Chunk take(uint32_t cu, uint32_t cv, const std::vector<Label>& label_of, ChunkDecoder& decoder) const;

 private:
  uint64_t place_of(uint32_t cu, uint32_t cv) const { return (uint64_t{cv} * shape_.chunks_u + cu) * 8; }
  const LevelShape shape_;
  SpillFile file_;  // for each chunk the offset of its last block, or 0 (the file is sparse); then the blocks, each with a head
  uint64_t end_;
};

// Writes the grid `meta` to `path`, with the labels of SpilledChanges::take(). progress(share) may throw.
void write_changes(const std::filesystem::path& path, const Metadata& meta, const SpilledChanges& changes, const std::vector<Label>& label_of,
                   const std::string& report, int threads, const std::function<void(double)>& progress);

}  // namespace teracell::store
