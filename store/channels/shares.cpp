// The coding `shares`, in which files up to version 3.1 have their fractions.
#include "store/channels/mixed_bodies.hpp"

namespace teracell::inline store {

void decode_shares(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, uint32_t total, MixedCells& out) {
  ByteReader in(mixed_body(frame, nu, nv), "mixed cells", "13.2");
  out.reset(nu, nv, length, total);
  take_sets(in, labels, out);
  const size_t sets = out.sets.size();
  std::vector<uint32_t> of_rays;  // runs
  uint64_t runs = 0;
  for (uint32_t ray = 0; ray < nu * nv; ++ray) {
    of_rays.push_back(static_cast<uint32_t>(in.varint(0, in.remaining(), "runs of a ray")));
    runs += of_rays.back();
    if (runs > in.remaining()) in.fail("there are more runs than bytes");
  }
  if (runs == 0) in.fail("there is no mixed cell");
  struct Place {
    uint32_t from, cells;
  };
  std::vector<Place> places(runs);
  for (Place& p : places) p.from = static_cast<uint32_t>(in.varint(0, ~uint32_t{0}, "begin of a run"));
  for (Place& p : places) p.cells = static_cast<uint32_t>(in.varint(0, length - 1, "length of a run")) + 1;
  uint64_t counts = 0, coded = 0;
  for (uint64_t i = 0; i < runs; ++i) {
    const uint32_t set = sets == 1 ? 0 : static_cast<uint32_t>(in.varint(0, sets - 1, "set of a run"));
    const size_t n = out.sets[set].size();
    if (n > total) in.fail("a cell has more labels than sub-samples");
    out.name_set(1, set, counts);
    counts += n, coded += n - 1;
    if (coded > in.remaining()) in.fail("there are more counts than bytes");
  }
  const auto low = in.take(coded), high = total > 256 ? in.take(coded) : std::span<const uint8_t>();
  in.expect_end();

  in.clause("13.3");
  uint32_t first = 0, run = 0;
  for (const uint32_t of_ray : of_rays) {
    uint64_t end = 0;
    for (uint32_t i = 0; i < of_ray; ++i, ++run) {
      const Place& place = places[run];
      const uint64_t from = i == 0 ? uint64_t{first + static_cast<uint32_t>(from_zigzag(place.from))} : end + place.from;
      if (i == 0) first = static_cast<uint32_t>(from);
      if (i == 0 || from > end) out.stretches.push_back({static_cast<uint32_t>(from), run});
      if (place.cells > 1) out.longer.push_back({run, place.cells});
      end = from + place.cells;
      if (end > length) in.fail("a run of mixed cells ends beyond its ray");
    }
    out.end_ray();
  }
  out.counts.resize(counts);
  fill_counts(
      in, [&](size_t i) { return low[i] | (high.empty() ? 0u : uint32_t{high[i]} << 8); }, out);
}

}  // namespace teracell::store
