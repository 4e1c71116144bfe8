// The coding `stretches` (FORMAT.md 13.5 to 13.7).
#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "store/channels/mixed_bodies.hpp"
#include "store/format/format.hpp"

namespace teracell::inline store {
namespace {

constexpr int kCellsZstdLevel = 1;
constexpr uint64_t kMostRuns = uint64_t{1} << 24;  // with their counts they have some 24 bytes each in memory

// A number of sub-samples, less one, has so many bits.
int bits_of(uint32_t total) { return std::countr_zero(total); }
uint64_t counts_bytes(uint64_t counts, uint32_t total) { return (counts * static_cast<uint64_t>(bits_of(total)) + 7) / 8; }

uint32_t zigzag(int32_t v) { return (static_cast<uint32_t>(v) << 1) ^ static_cast<uint32_t>(v >> 31); }

// ---- encoding

// Numbers one after another. Room for those of a ray is made at once: asking for it number by number took half of the encoder's time.
struct Numbers {
  Bytes bytes;
  size_t size = 0;  // of what `bytes` has; the rest of them is anything
  // Where the next `most` bytes may be written.
  uint8_t* room(size_t most) {
    if (bytes.size() < size + most) bytes.resize(2 * (size + most));
    return bytes.data() + size;
  }
  void end_at(const uint8_t* end) { size = static_cast<size_t>(end - bytes.data()); }
};

constexpr size_t kMostVarint = 5;  // bytes of a number of 32 bits

uint8_t* varint_at(uint8_t* at, uint32_t value) {
  for (; value >= 0x80; value >>= 7) *at++ = static_cast<uint8_t>(value | 0x80);
  *at++ = static_cast<uint8_t>(value);
  return at;
}

void put_u64(uint8_t* at, uint64_t value) {
  for (int i = 0; i < 8; ++i) at[i] = static_cast<uint8_t>(value >> (8 * i));
}

// Appends numbers of so many bits, the first one in the lowest bits: number(i) for all i below `count`. Eight of them fill whole bytes.
template <class Number>
void pack(size_t count, int bits, const Number& number, Bytes& out) {
  if (count == 0) return;
  const size_t before = out.size();
  out.resize(before + (count + 7) / 8 * static_cast<size_t>(bits) + 16);
  uint8_t* at = out.data() + before;
  const auto four = [&](size_t i) { return number(i) | number(i + 1) << bits | number(i + 2) << 2 * bits | number(i + 3) << 3 * bits; };
  const auto put = [&](uint64_t lower, uint64_t upper) {
    put_u64(at, bits == 16 ? lower : lower | upper << 4 * bits);
    put_u64(at + 8, upper >> (64 - 4 * bits));
    at += bits;
  };
  size_t i = 0;
  for (; i + 8 <= count; i += 8) put(four(i), four(i + 4));
  uint64_t rest[2] = {0, 0};
  for (size_t k = i; k < count; ++k) rest[(k - i) / 4] |= number(k) << (k - i) % 4 * static_cast<size_t>(bits);
  put(rest[0], rest[1]);
  out.resize(before + (count * static_cast<size_t>(bits) + 7) / 8);
}

}  // namespace

struct MixedCellsEncoder::Scratch {
  ZstdEncoder zstd;
  Bytes body, longer;
  Numbers begins, sizes;
  std::vector<uint32_t> latest;  // where the latest stretches begin that were the first, the second and so on of their rays
  std::vector<uint16_t> counts;

  void put_stretches(const MixedCells& cells);
  void put_counts(const MixedCells& cells, Bytes& out);
};

MixedCellsEncoder::MixedCellsEncoder() : s_(std::make_unique<Scratch>()) {}
MixedCellsEncoder::~MixedCellsEncoder() = default;

// Where the runs lie. Most stretches have two or three, and no processor foresees which; so the loop is the same for the first run of a stretch and
// for the others.
void MixedCellsEncoder::Scratch::put_stretches(const MixedCells& cells) {
  begins.size = sizes.size = 0;
  longer.clear(), latest.clear();
  uint32_t between = 0, longer_runs = 0;  // between: runs of one cell since the latest longer one
  for (uint32_t ray = 0; ray < cells.nu * cells.nv; ++ray) {
    const auto runs = cells.of_ray(ray);
    if (runs.empty()) {
      put_varint(body, 0);
      continue;
    }
    if (latest.size() < runs.size()) latest.resize(2 * runs.size());
    uint8_t *begin = begins.room(kMostVarint * runs.size()), *size = sizes.room(kMostVarint * runs.size());
    uint32_t before = ~uint32_t{0}, stretches = 0, others = 0;  // others: runs of the stretch after its first one
    uint8_t* size_end = size;
    for (const MixedCells::Run& run : runs) {
      const bool is_first = run.from != before;
      before = run.to;
      stretches += is_first;
      uint32_t& start = latest[stretches - 1];
      const uint32_t number = zigzag(static_cast<int32_t>(run.from - start));
      start = is_first ? run.from : start;
      *begin = static_cast<uint8_t>(number);
      if (number < 0x80) begin += is_first;
      else if (is_first) begin = varint_at(begin, number);
      size = is_first ? size_end : size;
      others = is_first ? 0 : others + 1;
      *size = static_cast<uint8_t>(others);
      size_end = others < 0x80 ? size + 1 : varint_at(size, others);
      ++between;
      if (run.to - run.from > 1) {
        put_varint(longer, between - 1), put_varint(longer, run.to - run.from - 2);
        between = 0, ++longer_runs;
      }
    }
    put_varint(body, stretches);
    begins.end_at(begin), sizes.end_at(size_end);
  }
  for (const Numbers* part : {&begins, &sizes})
    body.insert(body.end(), part->bytes.begin(), part->bytes.begin() + static_cast<ptrdiff_t>(part->size));
  put_varint(body, longer_runs);
  body.insert(body.end(), longer.begin(), longer.end());
}

// Of each run the counts of all labels but the last, which has what is left. Those of the runs stand side by side.
void MixedCellsEncoder::Scratch::put_counts(const MixedCells& cells, Bytes& out) {
  const int bits = bits_of(cells.total);
  if (cells.sets.size() == 1 && cells.sets[0].size() == 2) {
    const uint32_t* const first = cells.counts.data();
    return pack(
        cells.runs.size(), bits, [&](size_t i) { return uint64_t{first[2 * i] - 1}; }, out);
  }
  counts.clear();
  for (const MixedCells::Run& run : cells.runs)
    for (const uint32_t count : cells.counts_of(run).first(cells.sets[run.set].size() - 1)) counts.push_back(static_cast<uint16_t>(count - 1));
  pack(
      counts.size(), bits, [&](size_t i) { return uint64_t{counts[i]}; }, out);
}

Bytes MixedCellsEncoder::encode(const MixedCells& cells) {
  Scratch& s = *s_;
  s.body.clear();
  put_varint(s.body, cells.sets.size());
  for (uint32_t i = 0; i < cells.sets.size(); ++i) put_set(s.body, {cells.sets[i].begin(), cells.sets[i].end()});
  s.put_stretches(cells);
  if (cells.sets.size() > 1)
    for (const MixedCells::Run& run : cells.runs) put_varint(s.body, run.set);
  const uint64_t bytes = s.body.size() + counts_bytes(cells.counts.size() - cells.runs.size(), cells.total);
  if (bytes > kCellsBound.most || cells.runs.size() > kMostRuns)
    throw InputError(fmt::format(
        "a chunk of {} x {} rays has {} runs of mixed cells in {} bytes, and at most {} runs and {} MiB fit in it: the surface is finer than the "
        "chunks can hold",
        cells.nu, cells.nv, cells.runs.size(), bytes, kMostRuns, kCellsBound.most >> 20));
  const Bytes frame = s.zstd.encode(s.body, kCellsZstdLevel, kCellsBound);
  Bytes out;
  out.reserve(8 + frame.size() + cells.counts.size() * sizeof(uint16_t) + 16);
  put_fixed<uint32_t>(out, kSkippableMagic), put_fixed<uint32_t>(out, 0);
  out.insert(out.end(), frame.begin(), frame.end());
  s.put_counts(cells, out);
  for (size_t i = 0; i < 4; ++i) out[4 + i] = static_cast<uint8_t>((out.size() - 8) >> (8 * i));
  return out;
}

// ---- decoding

void decode_mixed_cells(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, uint32_t total, MixedCells& out) {
  ByteReader all(frame, "mixed cells", "13.5");
  const auto magic = all.fixed<uint32_t>(), size = all.fixed<uint32_t>();
  if (magic != kSkippableMagic || size != all.remaining())
    all.fail(fmt::format("expected a skippable frame ({:08x}) of {} bytes, found {:08x} of {}", kSkippableMagic, all.remaining(), magic, size));
  const size_t body_size = zstd_frame_size(frame.subspan(8));
  if (body_size == 0) all.fail("expected a zstd frame");
  const auto body_frame = all.take(body_size), packed = all.take(all.remaining());
  const Bytes& body = mixed_body(body_frame, nu, nv);
  if (body.size() + packed.size() > kCellsBound.most)
    all.fail(fmt::format("a chunk has at most {} bytes, found {} and {} of counts", kCellsBound.most, body.size(), packed.size()));
  ByteReader in(body, "mixed cells", "13.6");
  out.reset(nu, nv, length, total);
  take_sets(in, labels, out);
  const uint32_t sets = out.sets.size();
  for (uint32_t i = 0; i < sets; ++i)
    if (out.sets[i].size() > total) in.fail("a cell has more labels than sub-samples");

  std::vector<uint32_t> begins, sizes;
  uint64_t stretches = 0, runs = 0;
  for (uint32_t ray = 0; ray < nu * nv; ++ray) {
    stretches += in.varint(0, in.remaining(), "stretches of a ray");
    if (stretches > in.remaining()) in.fail("there are more stretches than bytes");
    out.begin.push_back(static_cast<uint32_t>(stretches));
  }
  if (stretches == 0) in.fail("there is no mixed cell");
  // Each has two bytes and a run.
  if (stretches > std::min<uint64_t>(in.remaining() / 2, kMostRuns))
    in.fail(fmt::format("there are {} stretches, more than bytes for them", stretches));
  begins.resize(stretches), sizes.resize(stretches);
  for (uint32_t& begin : begins) begin = static_cast<uint32_t>(in.varint(0, ~uint32_t{0}, "begin of a stretch"));
  for (uint32_t& count : sizes) {
    count = static_cast<uint32_t>(in.varint(0, length - 1, "runs of a stretch")) + 1;
    runs += count;
  }
  // So many can differ from each other: by the numbers of their sets, by their counts, or by where they lie.
  const size_t of_set = out.sets[0].size();
  const uint64_t most = sets > 1 ? in.remaining() : of_set > 1 ? packed.size() * 8 / static_cast<uint64_t>(bits_of(total)) : stretches;
  if (runs > std::min(most, kMostRuns)) in.fail(fmt::format("there are {} runs, but at most {} can be told apart", runs, std::min(most, kMostRuns)));
  out.runs.resize(runs);
  for (MixedCells::Run& run : out.runs) run.to = 1;  // its cells
  const uint64_t longer_runs = in.varint(0, runs, "longer runs");
  uint64_t next_longer = 0;
  for (uint64_t i = 0; i < longer_runs; ++i) {
    next_longer += in.varint(0, runs, "runs of one cell");
    if (next_longer >= runs) in.fail("a longer run is beyond the last one");
    out.runs[next_longer++].to = static_cast<uint32_t>(in.varint(0, length, "cells of a run")) + 2;
  }
  uint64_t counts = 0, coded = 0;
  for (MixedCells::Run& run : out.runs) {
    run.set = sets == 1 ? 0 : static_cast<uint32_t>(in.varint(0, sets - 1, "set of a run"));
    const size_t n = out.sets[run.set].size();
    run.first = static_cast<uint32_t>(counts);
    counts += n, coded += n - 1;
  }
  in.expect_end();
  in.clause("13.5");
  const auto bits = static_cast<uint64_t>(bits_of(total));
  if (packed.size() != counts_bytes(coded, total))
    in.fail(fmt::format("{} counts of {} bits are expected, found {} bytes", coded, bits, packed.size()));
  if (coded * bits % 8 != 0 && packed.back() >> coded * bits % 8 != 0) in.fail("the bits behind the last count are not 0");

  in.clause("13.7");
  std::vector<uint32_t> latest;
  MixedCells::Run* run = out.runs.data();
  for (uint32_t ray = 0, stretch = 0; ray < nu * nv; ++ray) {
    uint64_t end = 0;
    const uint32_t of_ray = out.begin[ray + 1] - stretch;
    if (latest.size() < of_ray) latest.resize(of_ray);
    for (uint32_t i = 0; i < of_ray; ++i, ++stretch) {
      uint64_t from = latest[i] = latest[i] + static_cast<uint32_t>(from_zigzag(begins[stretch]));
      if (from < end + (i > 0)) in.fail("a stretch begins before the one before it ends");
      for (uint32_t k = 0; k < sizes[stretch]; ++k, ++run) {
        end = from + run->to;
        if (end > length) in.fail("a run of mixed cells ends beyond its ray");
        run->from = static_cast<uint32_t>(from), run->to = static_cast<uint32_t>(end);
        from = end;
      }
    }
    out.begin[ray + 1] = static_cast<uint32_t>(run - out.runs.data());
  }
  out.counts.resize(counts);
  const auto number = [&, mask = (uint64_t{1} << bits) - 1](uint64_t i) {
    const uint64_t bit = i * bits, byte = bit / 8;
    uint64_t word = 0;
    if (byte + 4 <= packed.size()) word = fixed_at<uint32_t>(&packed[byte]);
    else
      for (uint64_t k = byte; k < packed.size(); ++k) word |= uint64_t{packed[k]} << 8 * (k - byte);
    return static_cast<uint32_t>(word >> bit % 8 & mask);
  };
  fill_counts(in, number, out);
}

}  // namespace teracell::store
