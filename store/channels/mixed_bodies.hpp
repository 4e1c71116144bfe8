// What the codings of mixed cells have in common. For the store's own sources.
#pragma once
#include <fmt/format.h>

#include "store/base/zstd_frame.hpp"
#include "store/channels/mixed_cells.hpp"
#include "store/runs/chunk_codec.hpp"

namespace teracell::inline store {

inline constexpr BodyBound kCellsBound{kMaxChunkBytes / 4, kChunkBytesOfAnyFrame};  // runs and counts in memory have more bytes than in a body

inline int32_t from_zigzag(uint32_t v) { return static_cast<int32_t>(v >> 1) ^ -static_cast<int32_t>(v & 1); }

// Checks the size of the chunk, and gives the body of its zstd frame, which is valid until the thread's next call.
inline const Bytes& mixed_body(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv) {
  if (uint64_t{nu} * nv > kMaxChunkRays)
    throw FormatError(fmt::format("a chunk of {} x {} rays is larger than a file may have (FORMAT.md 7.6)", nu, nv));
  thread_local ZstdDecoder zstd;
  thread_local Bytes body;
  zstd.decode(frame, kCellsBound, "mixed cells", body);
  return body;
}

// Takes the sets that a body begins with.
inline void take_sets(ByteReader& in, uint32_t labels, MixedCells& out) {
  const uint64_t sets = in.varint(1, in.remaining(), "sets");
  for (uint64_t i = 0; i < sets; ++i)
    if (out.sets.intern(take_set(in, labels, labels)) != i) in.fail("a set occurs twice");
}

// Fills the counts of all runs, which have their sets and places; less(i) is the i-th number that is coded.
template <class Less>
void fill_counts(ByteReader& in, const Less& less, MixedCells& out) {
  in.clause("13.4");
  size_t next = 0;
  for (uint32_t run = 0; run < out.runs; ++run) {
    const MixedCells::Shares shares = out.shares_of(run);
    const size_t n = out.sets[shares.set].size();
    uint32_t left = out.total;
    for (size_t i = 0; i + 1 < n; ++i, ++next) {
      const uint32_t count = less(next) + 1;
      if (count >= left) in.fail("the shares of a cell are more than the whole");
      out.counts[shares.first + i] = count;
      left -= count;
    }
    out.counts[shares.first + n - 1] = left;
  }
}

}  // namespace teracell::store
