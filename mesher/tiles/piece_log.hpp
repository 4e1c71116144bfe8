// Pieces of bytes that are kept one after another, in a file without a name, on disk or in memory, and read once all are there.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "store/base/background.hpp"
#include "store/base/spill.hpp"

namespace teracell::mesher {

// Not thread-safe while it is filled; then threads may read at once. Throws what a SpillFile throws.
class PieceLog {
 public:
  struct Piece {
    uint64_t offset, bytes;
    uint64_t checksum;  // of what lies on a disk
  };
  // Throws unless the budget's folder has `expected` bytes of free space; with `in_memory` none is used, if the system has files in memory. With
  // `own_writer` another thread writes. Up to 18 blocks of 64 to 256 KiB, by the budget, wait for it.
  PieceLog(const Budget& budget, uint64_t expected, bool in_memory, bool own_writer);

  // REQUIRES: 1 to kMostOfPiece bytes.
  static constexpr size_t kMostOfPiece = size_t{1} << 20;
  Piece add(std::span<const uint8_t> bytes);
  // To be called before pieces are read, and again when more were added.
  void finish();
  // The bytes of a piece, in `room`; for any thread. Throws IoError if those on a disk are not those that were added.
  std::span<const uint8_t> read(const Piece& piece, std::vector<uint8_t>& room) const;

  uint64_t bytes() const { return end_; }  // ever added
  bool in_memory() const { return file_.in_memory(); }

 private:
  void hand_on();
  void write_waiting();
  void begin_block();
  const size_t block_;  // of the file: whole pages, and few calls
  SpillFile file_;
  JobLists<std::vector<uint8_t>> lists_;
  std::shared_ptr<std::vector<uint8_t>> waiting_;  // for the file: the bytes from handed_on_ to end_
  uint64_t handed_on_ = 0, end_ = 0;
  Background writer_;  // the last member, since its thread uses the others
};

}  // namespace teracell::mesher
