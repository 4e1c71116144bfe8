// Which bytes of a file belong to which chunk or page, as far as they were read. No two may share a byte (FORMAT.md 3.4). A hostile
// file of a few kilobytes could name one frame as millions of chunks.
#pragma once
#include <cstdint>
#include <map>
#include <mutex>

#include <fmt/format.h>

#include "store/base/error.hpp"
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
  void expect_own(const Owner& owner, const DirectoryEntry& frame) {
    const uint64_t end = frame.offset + frame.size;
    std::lock_guard lock(mutex_);
    auto after = claims_.upper_bound(frame.offset);  // the first that begins behind the frame's first byte
    if (after != claims_.begin()) {
      const auto& [first, claim] = *std::prev(after);
      if (first == frame.offset && claim.end == end && claim.owner == owner) return;
      if (claim.end > frame.offset)
        throw FormatError(fmt::format("byte {} belongs to two things that the index names (FORMAT.md 3.4)", frame.offset));
    }
    if (after != claims_.end() && after->first < end)
      throw FormatError(fmt::format("byte {} belongs to two things that the index names (FORMAT.md 3.4)", after->first));
    if (claims_.size() == kMost) claims_.clear(), after = claims_.end();
    claims_.emplace_hint(after, frame.offset, Claim{end, owner});
  }

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
