#include "store/channels/mixed_cells.hpp"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

#include "store/base/zstd_frame.hpp"
#include "store/runs/chunk_codec.hpp"

namespace teracell::inline store {
namespace {

constexpr int kCellsZstdLevel = 1;
constexpr BodyBound kCellsBound{kMaxChunkBytes / 4, kChunkBytesOfAnyFrame};  // runs and counts in memory have more bytes than in a body
// Of the numbers of sub-samples, each less one, the low and the high bytes stand apart: the high ones take half of their bits, the low ones
// none, so the entropy stage would find neither among the other.
bool has_high_bytes(uint32_t total) { return total > 256; }

uint32_t zigzag(int32_t v) { return (static_cast<uint32_t>(v) << 1) ^ static_cast<uint32_t>(v >> 31); }
int32_t unzigzag(uint32_t v) { return static_cast<int32_t>(v >> 1) ^ -static_cast<int32_t>(v & 1); }

}  // namespace

std::string beyond_bounds(const Subdivision& s) {
  uint64_t product = 1;
  for (const uint32_t n : s) {
    if (n < 1 || n > 256 || !std::has_single_bit(n)) return fmt::format("sub-samples along an axis are a power of two from 1 to 256, found {}", n);
    product *= n;
  }
  return product <= 65536 ? "" : fmt::format("a cell has at most 65536 sub-samples, found {} x {} x {} = {}", s[0], s[1], s[2], product);
}

void MixedCells::reset(uint32_t new_nu, uint32_t new_nv, uint32_t new_length, uint32_t new_total) {
  nu = new_nu, nv = new_nv, length = new_length, total = new_total;
  begin.assign(1, 0);
  runs.clear();
  sets.clear();
  counts.clear();
}

void MixedCells::add(uint32_t from, uint32_t to, std::span<const uint32_t> labels, std::span<const uint32_t> of_labels) {
  if (runs.size() > begin.back()) {
    Run& last = runs.back();
    if (last.to == from && same(sets[last.set], labels) && same(counts_of(last), of_labels)) {
      last.to = to;
      return;
    }
  }
  const bool again = !runs.empty() && same(sets[runs.back().set], labels);
  runs.push_back({from, to, again ? runs.back().set : sets.intern(labels), static_cast<uint32_t>(counts.size())});
  counts.insert(counts.end(), of_labels.begin(), of_labels.end());
}

MixedCells cut(const MixedCells& cells, uint32_t from, uint32_t to) {
  MixedCells out;
  out.reset(cells.nu, cells.nv, to - from, cells.total);
  for (uint32_t ray = 0; ray < cells.nu * cells.nv; ++ray) {
    for (const MixedCells::Run& run : cells.of_ray(ray))
      if (run.to > from && run.from < to)
        out.add(std::max(run.from, from) - from, std::min(run.to, to) - from, cells.labels(run), cells.counts_of(run));
    out.end_ray();
  }
  return out;
}

// ---- encoding

namespace {

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

}  // namespace

struct MixedCellsEncoder::Scratch {
  ZstdEncoder zstd;
  Bytes body;
  Numbers begins, lengths, sets, low, high;
};

MixedCellsEncoder::MixedCellsEncoder() : s_(std::make_unique<Scratch>()) {}
MixedCellsEncoder::~MixedCellsEncoder() = default;

Bytes MixedCellsEncoder::encode(const MixedCells& cells) {
  Scratch& s = *s_;
  s.body.clear();
  for (Numbers* part : {&s.begins, &s.lengths, &s.sets, &s.low, &s.high}) part->size = 0;
  put_varint(s.body, cells.sets.size());
  for (uint32_t i = 0; i < cells.sets.size(); ++i) put_set(s.body, {cells.sets[i].begin(), cells.sets[i].end()});
  const bool one_set = cells.sets.size() == 1, high_bytes = has_high_bytes(cells.total);
  const size_t of_one_set = one_set ? cells.sets[0].size() : 0;
  uint32_t first = 0;  // where the runs of the latest ray with runs begin
  for (uint32_t ray = 0; ray < cells.nu * cells.nv; ++ray) {
    const auto runs = cells.of_ray(ray);
    put_varint(s.body, runs.size());
    if (runs.empty()) continue;
    const uint32_t* count = cells.counts.data() + runs.front().first;  // those of a ray lie side by side
    const size_t counts = (runs.back().first - runs.front().first) + cells.counts_of(runs.back()).size() - runs.size();
    uint8_t *begin = s.begins.room(kMostVarint * runs.size()), *length = s.lengths.room(kMostVarint * runs.size());
    uint8_t* set = one_set ? nullptr : s.sets.room(kMostVarint * runs.size());
    uint8_t *low = s.low.room(counts), *high = high_bytes ? s.high.room(counts) : nullptr;
    uint32_t before = 0;
    for (const MixedCells::Run& run : runs) {
      begin = varint_at(begin, &run == &runs[0] ? zigzag(static_cast<int32_t>(run.from - first)) : run.from - before);
      length = varint_at(length, run.to - run.from - 1);
      before = run.to;
      if (!one_set) set = varint_at(set, run.set);
      const size_t labels = one_set ? of_one_set : cells.sets[run.set].size();
      for (size_t i = 0; i + 1 < labels; ++i) {  // the last one is what is left
        const uint32_t less = *count++ - 1;
        *low++ = static_cast<uint8_t>(less);
        if (high_bytes) *high++ = static_cast<uint8_t>(less >> 8);
      }
      ++count;
    }
    s.begins.end_at(begin), s.lengths.end_at(length), s.low.end_at(low);
    if (!one_set) s.sets.end_at(set);
    if (high_bytes) s.high.end_at(high);
    first = runs[0].from;
  }
  for (const Numbers* part : {&s.begins, &s.lengths, &s.sets, &s.low, &s.high})
    s.body.insert(s.body.end(), part->bytes.begin(), part->bytes.begin() + static_cast<ptrdiff_t>(part->size));
  if (s.body.size() > kCellsBound.most)
    throw InputError(
        fmt::format("a chunk of {} x {} rays has {} runs of mixed cells, more than fit in {} MiB: the surface is finer than the chunks "
                    "can hold",
                    cells.nu, cells.nv, cells.runs.size(), kCellsBound.most >> 20));
  return s.zstd.encode(s.body, kCellsZstdLevel, kCellsBound);
}

// ---- decoding

void decode_mixed_cells(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, uint32_t total, MixedCells& out) {
  if (uint64_t{nu} * nv > kMaxChunkRays)
    throw FormatError(fmt::format("a chunk of {} x {} rays is larger than a file may have (FORMAT.md 7.6)", nu, nv));
  thread_local ZstdDecoder zstd;
  thread_local Bytes body;
  zstd.decode(frame, kCellsBound, "mixed cells", body);
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
  const auto low = in.take(coded), high = has_high_bytes(total) ? in.take(coded) : std::span<const uint8_t>();
  in.expect_end();

  in.clause("13.3");
  uint32_t first = 0;
  for (uint32_t ray = 0; ray < nu * nv; ++ray) {
    uint64_t end = 0;
    for (uint32_t i = out.begin[ray]; i < out.begin[ray + 1]; ++i) {
      MixedCells::Run& run = out.runs[i];
      const bool leads = i == out.begin[ray];
      const uint64_t from = leads ? uint64_t{first + static_cast<uint32_t>(unzigzag(run.from))} : end + run.from;
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
