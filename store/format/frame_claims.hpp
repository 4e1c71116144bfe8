// Which bytes of a file belong to which chunk or page, as far as they were read. No two may share a byte (FORMAT.md 3.4). A hostile
// file of a few kilobytes could name one frame as millions of chunks.
#pragma once
#include <cstdint>
#include <map>
#include <mutex>

#include "store/format/format.hpp"

namespace teracell::inline store {

// Threads may share it.
class FrameClaims {
 public:
  struct Owner {
    int level;        // below 0: a channel of cells
    bool page;        // or else a chunk
    uint64_t number;  // of the page; of a chunk: that of its page, and then its slot
    friend bool operator==(const Owner&, const Owner&) = default;
  };
  // Throws FormatError if the frame has bytes that are known to belong to another owner.
  void expect_own(const Owner& owner, const DirectoryEntry& frame);

 private:
  // More than the smallest frames of 64 kB. Beyond that, it forgets: a larger file has more bytes to pay with.
  static constexpr size_t kMost = 8192;
  struct Claim {
    uint64_t end;
    Owner owner;
  };
  std::mutex mutex_;
  std::map<uint64_t, Claim> claims_;  // by their first byte
};

}  // namespace teracell::store
