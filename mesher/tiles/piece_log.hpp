// Pieces of bytes that are kept one after another, in memory or in a file without a name, and read once all are there.
#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "store/base/background.hpp"
#include "store/base/spill.hpp"

namespace teracell::mesher {

// Not thread-safe while it is filled; then threads may read at once. Throws what a SpillFile throws.
class PieceLog {
 public:
  struct Piece {
    uint64_t offset, bytes, checksum;
  };
  // Throws unless the budget's folder has `expected` bytes of free space; with `in_memory` none is used. With `own_writer` another thread writes to
  // the disk, or asks for memory. Up to 18 blocks of 64 to 256 KiB, by the budget, wait for it.
  PieceLog(const Budget& budget, uint64_t expected, bool in_memory, bool own_writer);

  // REQUIRES: 1 to kMostOfPiece bytes.
  static constexpr size_t kMostOfPiece = size_t{1} << 20;
  Piece add(std::span<const uint8_t> bytes);
  // To be called before pieces are read, and again when more were added.
  void finish();
  // No more is added: frees memory that was asked for ahead.
  void close();
  // The bytes of a piece, in `room` or where they lie; for any thread. Throws IoError if they are not those that were added.
  std::span<const uint8_t> read(const Piece& piece, std::vector<uint8_t>& room) const;

  uint64_t bytes() const { return end_; }  // ever added
  bool in_memory() const { return !file_; }

 private:
  void hand_on();
  void begin_block();
  void hold_block();
  static constexpr size_t kBlockInMemory = size_t{1} << 24;  // so large that a piece wastes little of a block's end
  const uint64_t expected_;  // bytes, about
  const size_t block_;  // of the file: whole pages, and few calls
  std::optional<SpillFile> file_;
  using Block = std::unique_ptr<uint8_t[]>;
  std::vector<Block> held_;  // blocks in memory, all but the last one full
  Block next_held_;  // made ready by the other thread
  size_t used_ = kBlockInMemory;  // of the last one
  JobLists<std::vector<uint8_t>> lists_;
  std::shared_ptr<std::vector<uint8_t>> waiting_;  // for the file: the bytes from handed_on_ to end_
  uint64_t handed_on_ = 0, end_ = 0;
  Background writer_;  // the last member, since its thread uses the others
};

}  // namespace teracell::mesher
