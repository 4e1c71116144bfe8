// The coding `shares`, in which files up to version 3.1 have their fractions.
#include <fmt/format.h>

#include "store/base/zstd_frame.hpp"
#include "store/channels/mixed_cells.hpp"
#include "store/runs/chunk_codec.hpp"

namespace teracell::inline store {
namespace {

constexpr BodyBound kSharesBound{kMaxChunkBytes / 4, kChunkBytesOfAnyFrame};  // runs and counts in memory have more bytes than in a body

int32_t step_of(uint32_t v) { return static_cast<int32_t>(v >> 1) ^ -static_cast<int32_t>(v & 1); }

}  // namespace

void decode_shares(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, uint32_t total, MixedCells& out) {
  if (uint64_t{nu} * nv > kMaxChunkRays)
    throw FormatError(fmt::format("a chunk of {} x {} rays is larger than a file may have (FORMAT.md 7.6)", nu, nv));
  thread_local ZstdDecoder zstd;
  thread_local Bytes body;
  zstd.decode(frame, kSharesBound, "mixed cells", body);
  ByteReader in(body, "mixed cells", "13.2");
  out.reset(nu, nv, length, total);
  const uint64_t sets = in.varint(1, in.remaining(), "sets");
  for (uint64_t i = 0; i < sets; ++i)
    if (out.sets.intern(take_set(in, labels, labels)) != i) in.fail("a set occurs twice");

  uint64_t runs = 0;
  for (uint32_t ray = 0; ray < nu * nv; ++ray) {
    runs += in.varint(0, in.remaining(), "runs of a ray");
    if (runs > in.remaining()) in.fail("there are more runs than bytes");
    out.begin.push_back(static_cast<uint32_t>(runs));
  }
  if (runs == 0) in.fail("there is no mixed cell");
  out.runs.resize(runs);
  for (MixedCells::Run& run : out.runs) run.from = static_cast<uint32_t>(in.varint(0, ~uint32_t{0}, "begin of a run"));
  for (MixedCells::Run& run : out.runs) run.to = static_cast<uint32_t>(in.varint(0, length - 1, "length of a run")) + 1;
  uint64_t counts = 0, coded = 0;
  for (MixedCells::Run& run : out.runs) {
    run.set = sets == 1 ? 0 : static_cast<uint32_t>(in.varint(0, sets - 1, "set of a run"));
    const size_t n = out.sets[run.set].size();
    if (n > total) in.fail("a cell has more labels than sub-samples");
    run.first = static_cast<uint32_t>(counts);
    counts += n, coded += n - 1;
    if (coded > in.remaining()) in.fail("there are more counts than bytes");
  }
  const auto low = in.take(coded), high = total > 256 ? in.take(coded) : std::span<const uint8_t>();
  in.expect_end();

  in.clause("13.3");
  uint32_t first = 0;
  for (uint32_t ray = 0; ray < nu * nv; ++ray) {
    uint64_t end = 0;
    for (uint32_t i = out.begin[ray]; i < out.begin[ray + 1]; ++i) {
      MixedCells::Run& run = out.runs[i];
      const bool leads = i == out.begin[ray];
      const uint64_t from = leads ? uint64_t{first + static_cast<uint32_t>(step_of(run.from))} : end + run.from;
      end = from + run.to;
      if (end > length) in.fail("a run of mixed cells ends beyond its ray");
      run.from = static_cast<uint32_t>(from), run.to = static_cast<uint32_t>(end);
      if (leads) first = run.from;
    }
  }
  in.clause("13.4");
  out.counts.resize(counts);
  size_t next = 0;
  for (const MixedCells::Run& run : out.runs) {
    const size_t n = out.sets[run.set].size();
    uint32_t left = total;
    for (size_t i = 0; i + 1 < n; ++i, ++next) {
      const uint32_t count = (low[next] | (high.empty() ? 0u : uint32_t{high[next]} << 8)) + 1;
      if (count >= left) in.fail("the shares of a cell are more than the whole");
      out.counts[run.first + i] = count;
      left -= count;
    }
    out.counts[run.first + n - 1] = left;
  }
}

}  // namespace teracell::store
