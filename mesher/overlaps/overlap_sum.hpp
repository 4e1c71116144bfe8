// The overlaps of all tiles. Tens of thousands of bodies may have millions of pairs, so they are held packed, in sorted pieces that are
// merged now and then; what outgrows the memory given goes to disk.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "mesher/overlaps/overlap.hpp"
#include "store/base/spill.hpp"

namespace teracell::mesher {

// A copy shares the disk space of what it was copied from. Not thread-safe, neither are copies of one another.
class OverlapSum {
 public:
  // From now on about a sixteenth of the budget, or 1 MB if that is more, is held in memory. The pairs are the same.
  void bound(const Budget& budget);
  void add(Bytes&& packed);
  void add(const OverlapSum& other);
  uint64_t on_disk() const { return disk_ ? disk_->end : 0; }  // bytes
  // Calls f for each pair, ascending. Throws FormatError when what was restored is damaged.
  void for_each(const std::function<void(const Overlap&)>& f) const;

  void save(Bytes& out) const;
  static OverlapSum restored(ByteReader& in);

 private:
  // Packed on their own, so that one at a time suffices to read a piece from disk.
  struct Block {
    Bytes bytes;          // or
    uint64_t offset = 0;  // on disk, and
    uint32_t size = 0;
  };
  using Piece = std::vector<Block>;  // its pairs ascend
  struct Disk {
    Disk(const std::filesystem::path& folder, uint64_t expected) : file(folder, expected) {}
    SpillFile file;
    uint64_t end = 0;
  };
  class Cursor;
  void add(Piece&& piece);
  void merge_recent();
  void spill();
  void merge(std::span<const Piece> pieces, const std::function<void(const Overlap&)>& f) const;
  void pack(std::span<const Piece> pieces, const std::function<void(Bytes&&)>& put_block) const;

  std::vector<Piece> pieces_;  // those on disk first
  size_t on_disk_ = 0;         // how many of them are
  uint64_t merged_bytes_ = 0;  // of pieces_[on_disk_], if it was merged
  uint64_t recent_bytes_ = 0;  // of the pieces after it
  uint64_t limit_ = ~uint64_t{0};
  std::filesystem::path folder_;
  std::shared_ptr<Disk> disk_;
};

}  // namespace teracell::mesher
