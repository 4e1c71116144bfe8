// The coding `stretches` (FORMAT.md 13.5 to 13.7).
#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "store/channels/mixed_bodies.hpp"
#include "store/format/format.hpp"

namespace teracell::inline store {
namespace {

constexpr int kCellsZstdLevel = 1;
constexpr uint64_t kMostRuns = uint64_t{1} << 24;  // with their counts they have some 16 bytes each in memory

// A number of sub-samples, less one, has so many bits.
int bits_of(uint32_t total) { return std::countr_zero(total); }
uint64_t counts_bytes(uint64_t counts, uint32_t total) { return (counts * static_cast<uint64_t>(bits_of(total)) + 7) / 8; }

uint32_t zigzag(int32_t v) { return (static_cast<uint32_t>(v) << 1) ^ static_cast<uint32_t>(v >> 31); }

// ---- encoding

constexpr size_t kMostVarint = 5;  // bytes of a number of 32 bits

uint8_t* varint_at(uint8_t* at, uint32_t value) {
  for (; value >= 0x80; value >>= 7) *at++ = static_cast<uint8_t>(value | 0x80);
  *at++ = static_cast<uint8_t>(value);
  return at;
}

// Of so many numbers, as varints. Asking for it number by number took half of the encoder's time.
uint8_t* room(UnfilledVector<uint8_t>& of, size_t numbers) {
  if (of.size() < kMostVarint * numbers) of.resize(kMostVarint * numbers);
  return of.data();
}

// A compiler took byte by byte apart and together again, which was a third of the encoder's time.
void put_u64(uint8_t* at, uint64_t value) {
  if constexpr (std::endian::native == std::endian::big) value = __builtin_bswap64(value);
  std::memcpy(at, &value, sizeof value);
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
  Bytes body;
  UnfilledVector<uint8_t> begins, sizes;
  std::vector<uint32_t> latest;  // where the latest stretches begin that were the first, the second and so on of their rays
  std::vector<uint16_t> counts;

  void put_stretches(const MixedCells& cells);
  void put_counts(const MixedCells& cells, Bytes& out);
};

MixedCellsEncoder::MixedCellsEncoder() : s_(std::make_unique<Scratch>()) {}
MixedCellsEncoder::~MixedCellsEncoder() = default;

// Where the runs lie.
void MixedCellsEncoder::Scratch::put_stretches(const MixedCells& cells) {
  latest.clear();
  const size_t all = cells.stretches.size();
  uint8_t *begin = room(begins, all), *size = room(sizes, all);
  for (uint32_t ray = 0; ray < cells.nu * cells.nv; ++ray) {
    const size_t first = cells.begin[ray], of_ray = cells.begin[ray + 1] - first;
    put_varint(body, of_ray);
    if (latest.size() < of_ray) latest.resize(2 * of_ray);
    for (size_t i = 0; i < of_ray; ++i) {
      const MixedCells::Stretch& stretch = cells.stretches[first + i];
      begin = varint_at(begin, zigzag(static_cast<int32_t>(stretch.from - latest[i])));
      size = varint_at(size, cells.first_run(first + i + 1) - stretch.first_run - 1);
      latest[i] = stretch.from;
    }
  }
  body.insert(body.end(), begins.data(), begin);
  body.insert(body.end(), sizes.data(), size);
  put_varint(body, cells.longer.size());
  uint32_t next = 0;
  for (const MixedCells::Longer& run : cells.longer) {
    put_varint(body, run.run - next), put_varint(body, run.cells - 2);
    next = run.run + 1;
  }
}

// Of each run the counts of all labels but the last, which has what is left. Those of the runs stand side by side.
void MixedCellsEncoder::Scratch::put_counts(const MixedCells& cells, Bytes& out) {
  const int bits = bits_of(cells.total);
  if (cells.sets.size() == 1 && cells.sets[0].size() == 2) {
    const uint32_t* const first = cells.counts.data();
    return pack(
        cells.runs, bits, [&](size_t i) { return uint64_t{first[2 * i] - 1}; }, out);
  }
  counts.clear();
  for (uint32_t run = 0; run < cells.runs; ++run) {
    const MixedCells::Shares shares = cells.shares_of(run);
    for (size_t i = 0; i + 1 < cells.sets[shares.set].size(); ++i) counts.push_back(static_cast<uint16_t>(cells.counts[shares.first + i] - 1));
  }
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
    for (uint32_t run = 0; run < cells.runs; ++run) put_varint(s.body, cells.shares_of(run).set);
  const uint64_t bytes = s.body.size() + counts_bytes(cells.counts.size() - cells.runs, cells.total);
  if (bytes > kCellsBound.most || cells.runs > kMostRuns)
    throw InputError(fmt::format(
        "a chunk of {} x {} rays has {} runs of mixed cells in {} bytes, and at most {} runs and {} MiB fit in it: the surface is finer than the "
        "chunks can hold",
        cells.nu, cells.nv, cells.runs, bytes, kMostRuns, kCellsBound.most >> 20));
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
  out.stretches.resize(stretches);
  for (MixedCells::Stretch& s : out.stretches) s.from = static_cast<uint32_t>(in.varint(0, ~uint32_t{0}, "begin of a stretch"));
  for (MixedCells::Stretch& s : out.stretches) {
    s.first_run = static_cast<uint32_t>(runs);
    runs += in.varint(0, length - 1, "runs of a stretch") + 1;
    if (runs > kMostRuns) in.fail(fmt::format("there are {} runs, but at most {} fit in a chunk", runs, kMostRuns));
  }
  // So many can differ from each other: by the numbers of their sets, by their counts, or by where they lie.
  const size_t of_set = out.sets[0].size();
  const uint64_t most = sets > 1 ? in.remaining() : of_set > 1 ? packed.size() * 8 / static_cast<uint64_t>(bits_of(total)) : stretches;
  if (runs > most) in.fail(fmt::format("there are {} runs, but at most {} can be told apart", runs, most));
  const uint64_t longer_runs = in.varint(0, runs, "longer runs");
  if (longer_runs > in.remaining() / 2) in.fail(fmt::format("there are {} longer runs, more than bytes for them", longer_runs));
  out.longer.resize(longer_runs);
  uint64_t next_longer = 0;
  for (MixedCells::Longer& run : out.longer) {
    next_longer += in.varint(0, runs, "runs of one cell");
    if (next_longer >= runs) in.fail("a longer run is beyond the last one");
    run = {static_cast<uint32_t>(next_longer++), static_cast<uint32_t>(in.varint(0, length, "cells of a run")) + 2};
  }
  uint64_t coded = 0;
  if (sets == 1) {
    out.name_set(static_cast<uint32_t>(runs), 0, 0);
    coded = runs * (of_set - 1);
  } else {
    for (uint64_t i = 0; i < runs; ++i) {
      const auto set = static_cast<uint32_t>(in.varint(0, sets - 1, "set of a run"));
      out.name_set(1, set, coded + i);
      coded += out.sets[set].size() - 1;
    }
  }
  const uint64_t counts = coded + runs;
  in.expect_end();
  in.clause("13.5");
  const auto bits = static_cast<uint64_t>(bits_of(total));
  if (packed.size() != counts_bytes(coded, total))
    in.fail(fmt::format("{} counts of {} bits are expected, found {} bytes", coded, bits, packed.size()));
  if (coded * bits % 8 != 0 && packed.back() >> coded * bits % 8 != 0) in.fail("the bits behind the last count are not 0");

  in.clause("13.7");
  std::vector<uint32_t> latest;
  auto longer = out.longer.begin();
  for (uint32_t ray = 0; ray < nu * nv; ++ray) {
    uint64_t end = 0;
    const uint32_t first = out.begin[ray], of_ray = out.begin[ray + 1] - first;
    if (latest.size() < of_ray) latest.resize(of_ray);
    for (uint32_t i = 0; i < of_ray; ++i) {
      MixedCells::Stretch& stretch = out.stretches[first + i];
      const uint32_t last_run = out.first_run(first + size_t{i} + 1);
      const uint64_t from = latest[i] = latest[i] + static_cast<uint32_t>(from_zigzag(stretch.from));
      if (from < end + (i > 0)) in.fail("a stretch begins before the one before it ends");
      stretch.from = static_cast<uint32_t>(from);
      end = from + (last_run - stretch.first_run);
      for (; longer != out.longer.end() && longer->run < last_run; ++longer) end += longer->cells - 1;
      if (end > length) in.fail("a run of mixed cells ends beyond its ray");
    }
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
