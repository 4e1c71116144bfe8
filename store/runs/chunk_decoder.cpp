#include <algorithm>
#include <bit>
#include <cstring>

#include <fmt/format.h>

#include "store/runs/chunk_walk.hpp"

namespace teracell::inline store {

struct ChunkDecoder::Scratch {
  ZstdDecoder zstd;
  Bytes body;
  std::vector<SetId> palette, sets;
  std::vector<Stretch> stretches;
};

ChunkDecoder::ChunkDecoder() : s_(std::make_unique<Scratch>()) {}
ChunkDecoder::~ChunkDecoder() = default;

namespace {

void decode_palette(ByteReader& in, SetTable& sets, std::vector<SetId>& palette) {
  palette.resize(in.varint(1, in.remaining(), "palette size"));
  for (SetId& id : palette) id = sets.intern(take_set(in, sets.labels(), sets.labels()));
}

void decode_patterns(ByteReader& in, RayBlock& b, const std::vector<SetId>& palette, std::vector<SetId>& sets) {
  const uint64_t count = in.varint(1, std::min<uint64_t>(b.rays(), in.remaining()), "pattern count");
  for (uint64_t p = 0; p < count; ++p) {
    sets.resize(in.varint(0, std::min<uint64_t>(b.length - 1, in.remaining()), "changes of a pattern") + 1);
    for (size_t i = 0; i < sets.size(); ++i) {
      sets[i] = palette[in.varint(0, palette.size() - 1, "palette index")];
      if (i > 0 && sets[i] == sets[i - 1]) in.fail("a pattern repeats a set");
    }
    if (b.patterns.intern(sets) != p) in.fail("a pattern occurs twice");
  }
}

// The loops that take time are functions of their own: browsers compile one function after the other, and small ones soon (web/module).
//
// Most rays have the pattern of the ray above, and then their changes lie where the changes of that row lie, by so many later.
[[gnu::noinline]] void decode_pattern_of_rays(ByteReader& in, RayBlock& b) {
  const uint64_t count = in.varint(0, std::min<uint64_t>(b.rays(), in.remaining() / 2), "exceptions");
  std::vector<std::pair<uint32_t, uint32_t>> exceptions(count);  // ray, pattern
  uint64_t next = 0;
  for (auto& [ray, pattern] : exceptions) {
    next += in.varint(0, b.rays(), "gap");
    if (next >= b.rays()) in.fail("an exception lies beyond the last ray");
    ray = static_cast<uint32_t>(next++);
  }
  for (auto& [ray, pattern] : exceptions) pattern = static_cast<uint32_t>(in.varint(0, b.patterns.size() - 1, "pattern"));
  exceptions.emplace_back(b.rays(), 0);

  b.pattern.resize(b.rays());
  b.begin.resize(b.rays() + 1);
  uint64_t changes = 0;
  auto exception = exceptions.begin();
  for (uint32_t v = 0, ray = 0; v < b.nv; ++v) {
    const uint32_t end = ray + b.nu;
    while (ray < end) {
      const uint32_t u = ray - v * b.nu, stop = std::min(exception->first, end);
      if (ray < stop && v > 0 && (u == 0 || b.pattern[ray - 1] == b.pattern[ray - b.nu - 1])) {
        const uint32_t above = ray - b.nu, later = static_cast<uint32_t>(changes) - b.begin[above];
        std::copy_n(&b.pattern[above], stop - ray, &b.pattern[ray]);
        for (uint32_t i = 0; i < stop - ray; ++i) b.begin[ray + i] = b.begin[above + i] + later;
        changes += b.begin[stop - b.nu] - b.begin[above];
        ray = stop;
      } else {
        b.pattern[ray] = ray == exception->first ? exception++->second : expected_pattern(b.pattern, b.nu, u, v);
        b.begin[ray] = static_cast<uint32_t>(changes);
        changes += b.patterns.changes(b.pattern[ray++]);
      }
      if (changes > in.remaining()) in.fail("the rays have more changes than the chunk has bytes");  // also keeps 32 bits
    }
  }
  b.begin[b.rays()] = static_cast<uint32_t>(changes);
}

using Four = uint32_t __attribute__((vector_size(16)));
using FourFlags = int32_t __attribute__((vector_size(16)));  // 0 or -1

Four four(const uint32_t* from) {
  Four out;
  std::memcpy(&out, from, sizeof out);
  return out;
}

Four four(const uint8_t* from) {
  uint32_t bytes;
  std::memcpy(&bytes, from, sizeof bytes);
  // GCC moves byte after byte for __builtin_convertvector.
  using Sixteen = uint8_t __attribute__((vector_size(16)));
  using Eight = uint16_t __attribute__((vector_size(16)));
  constexpr Sixteen kZero{};
  const auto wide = (Sixteen)Four{bytes};
  if constexpr (std::endian::native == std::endian::big) return Four{wide[0], wide[1], wide[2], wide[3]};
  const auto wider = (Eight)__builtin_shufflevector(wide, kZero, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
  return (Four)__builtin_shufflevector(wider, (Eight)kZero, 0, 8, 1, 9, 2, 10, 3, 11);
}

// The sums of four residuals, one after another, and of those before them, of rays with N changes: each adds to that of the same change of the
// ray before.
template <uint32_t N>
Four summed(Four sum, const Four& before) {
  constexpr Four kNone{};
  if constexpr (N == 1) sum += __builtin_shufflevector(kNone, sum, 0, 4, 5, 6);
  if constexpr (N <= 2) sum += __builtin_shufflevector(kNone, sum, 0, 1, 4, 5);
  if constexpr (N == 3) sum += __builtin_shufflevector(kNone, sum, 0, 1, 2, 4);
  return sum + __builtin_shufflevector(before, before, 4 - N, 4 - N + 1 % N, 4 - N + 2 % N, 4 - N + 3 % N);
}

// The narrow residuals of a stretch of rays that the plane predicts.
struct Plane {
  ByteReader& wide;
  const uint8_t* narrow;
  const uint32_t* up;  // the changes of the rays above
  uint32_t* at;
  uint32_t size;

  uint32_t residual(uint32_t r) const { return unzigzag(r < kEscape ? r : r + static_cast<uint32_t>(wide.varint(0, ~0u - kEscape, "residual"))); }
  void decode(uint32_t n) const {
    switch (n) {
      case 1: return by_fours<1>();
      case 2: return by_fours<2>();
      case 3: return by_fours<3>();
      case 4: return by_fours<4>();
      default: return one_by_one(n, 0);
    }
  }
  void one_by_one(uint32_t n, uint32_t from) const {
    for (uint32_t i = from; i < size; ++i) at[i] = (at - n)[i] + up[i] - (up - n)[i] + residual(narrow[i]);
  }
  // A change lies behind the one above it by as much as that of the ray before does, plus its residual.
  template <uint32_t N>
  void by_fours() const {
    Four behind{};
    for (uint32_t k = 0; k < N; ++k) behind[4 - N + k] = (at - N)[k] - (up - N)[k];
    uint32_t i = 0;
    for (; i + 4 <= size; i += 4) {
      Four r = four(narrow + i);
      uint32_t bytes;
      std::memcpy(&bytes, narrow + i, sizeof bytes);
      if ((bytes & 0x80808080) == 0) r = (r >> 1) ^ -(r & 1);
      else
        for (uint32_t k = 0; k < 4; ++k) r[k] = residual(r[k]);
      behind = summed<N>(r, behind);
      const Four changes = four(up + i) + behind;
      std::memcpy(at + i, &changes, sizeof changes);
    }
    one_by_one(N, i);
  }
};

// Whether the changes of each ray ascend in (0, length).
[[gnu::noinline]] bool is_valid(const RayBlock& b, const std::vector<Stretch>& stretches) {
  const std::span<const uint32_t> at = b.at;
  const auto is_outside = [&](auto change) { return change - 1 >= b.length - 1; };  // 0 - 1 is the largest number
  // Descents are counted in one go; then those where a ray begins, which may be, are taken off.
  bool outside = !at.empty() && is_outside(at[0]);
  uint32_t descents = 0;
  FourFlags four_outside{}, four_descents{};
  size_t i = 1;
  for (; i + 4 <= at.size(); i += 4) {
    const Four here = four(&at[i]);
    four_outside |= is_outside(here);
    four_descents += here <= four(&at[i - 1]);
  }
  for (; i < at.size(); ++i) outside |= is_outside(at[i]), descents += at[i] <= at[i - 1];
  for (uint32_t k = 0; k < 4; ++k) outside |= four_outside[k] != 0, descents -= static_cast<uint32_t>(four_descents[k]);
  for (const auto& [ray, end, from] : stretches) {
    const uint32_t first = b.begin[ray], n = b.begin[ray + 1] - first;
    for (uint32_t begin = first; begin < b.begin[end]; begin += n) descents -= begin > 0 && at[begin] <= at[begin - 1];
  }
  return !outside && descents == 0;
}

[[gnu::noinline]] void decode_changes(ByteReader& in, RayBlock& b, std::vector<Stretch>& stretches) {
  b.at.resize(b.begin.back());
  uint64_t planar = 0;
  stretches.clear();
  walk(
      b,
      [&](uint32_t ray, From from) {
        stretches.push_back({ray, ray + 1, from});
      },
      [&](uint32_t from, uint32_t to) {
        stretches.push_back({from, to, From::kPlane});
        planar += b.begin[to] - b.begin[from];
      });
  const uint8_t* narrow = in.take(planar).data();
  for (const auto& [ray, end, from] : stretches) {
    uint32_t* at = b.at.data() + b.begin[ray];
    const uint32_t n = b.begin[ray + 1] - b.begin[ray], size = b.begin[end] - b.begin[ray];
    if (from == From::kPlane) {
      Plane{in, narrow, b.at.data() + b.begin[ray - b.nu], at, size}.decode(n);
      narrow += size;
      continue;
    }
    const uint32_t* like = b.at.data() + b.begin[from == From::kUp ? ray - b.nu : ray - (from == From::kLeft)];
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t wide = static_cast<uint32_t>(in.varint(0, ~0u, "change"));
      at[i] = from == From::kNothing ? (i == 0 ? 0 : at[i - 1]) + wide + 1 : like[i] + unzigzag(wide);
    }
  }
  if (!is_valid(b, stretches)) in.clause("11.4"), in.fail("the changes of a ray must ascend within it");
}

}  // namespace

void ChunkDecoder::decode(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, Chunk& out) {
  if (uint64_t{nu} * nv > kMaxChunkRays)
    throw FormatError(fmt::format("a chunk of {} x {} rays is larger than a file may have (FORMAT.md 7.6)", nu, nv));
  Scratch& s = *s_;
  s.zstd.decode(frame, kChunkBound, "chunk", s.body);

  ByteReader in(s.body, "chunk", "11.1");
  out.rays.nu = nu, out.rays.nv = nv, out.rays.length = length;
  out.rays.patterns.clear();  // all else is overwritten, and need not be cleared
  out.sets = SetTable(labels);
  decode_palette(in, out.sets, s.palette);
  decode_patterns(in, out.rays, s.palette, s.sets);
  decode_pattern_of_rays(in, out.rays);
  in.clause("11.3");
  decode_changes(in, out.rays, s.stretches);
  in.expect_end();
}

}  // namespace teracell::store
