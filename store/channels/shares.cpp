// The coding `shares`, in which files up to version 3.1 have their fractions.
#include "store/channels/mixed_bodies.hpp"

namespace teracell::inline store {

void decode_shares(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, uint32_t total, MixedCells& out) {
  ByteReader in(mixed_body(frame, nu, nv), "mixed cells", "13.2");
  out.reset(nu, nv, length, total);
  take_sets(in, labels, out);
  const size_t sets = out.sets.size();
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
      const uint64_t from = leads ? uint64_t{first + static_cast<uint32_t>(from_zigzag(run.from))} : end + run.from;
      end = from + run.to;
      if (end > length) in.fail("a run of mixed cells ends beyond its ray");
      run.from = static_cast<uint32_t>(from), run.to = static_cast<uint32_t>(end);
      if (leads) first = run.from;
    }
  }
  out.counts.resize(counts);
  fill_counts(
      in, [&](size_t i) { return low[i] | (high.empty() ? 0u : uint32_t{high[i]} << 8); }, out);
}

}  // namespace teracell::store
