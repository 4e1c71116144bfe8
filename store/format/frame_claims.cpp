#include "store/format/frame_claims.hpp"

#include <fmt/format.h>

namespace teracell::inline store {

void FrameClaims::expect_own(const Owner& owner, const DirectoryEntry& frame) {
  const uint64_t end = frame.offset + frame.size;
  std::lock_guard lock(mutex_);
  auto after = claims_.upper_bound(frame.offset);  // the first that begins behind the frame's first byte
  if (after != claims_.begin()) {
    const auto& [first, claim] = *std::prev(after);
    if (first == frame.offset && claim.end == end && claim.owner == owner) return;
    if (claim.end > frame.offset) throw FormatError(fmt::format("byte {} belongs to two things that the index names (FORMAT.md 3.4)", frame.offset));
  }
  if (after != claims_.end() && after->first < end)
    throw FormatError(fmt::format("byte {} belongs to two things that the index names (FORMAT.md 3.4)", after->first));
  if (claims_.size() == kMost) claims_.clear(), after = claims_.end();
  claims_.emplace_hint(after, frame.offset, Claim{end, owner});
}

}  // namespace teracell::store
