#include <algorithm>

#include <fmt/format.h>

#include "store/base/system/vector_units.hpp"
#include "store/runs/chunk_walk.hpp"

namespace teracell::inline store {
namespace {

constexpr int kZstdLevel = 1;  // 3 gains 2 %, 9 gains 6 % for five times the time

}  // namespace

struct ChunkEncoder::Scratch {
  ZstdEncoder zstd;
  Bytes body, gaps, exceptions, along, narrow, spelled, wide;
  size_t narrow_bytes = 0;  // of `narrow`, which is larger
  std::vector<SetId> palette;

  void put_patterns(const RayBlock& b, const SetTable& sets);
  void put_exceptions(const RayBlock& b);
  void put_changes(const RayBlock& b);
  void put_groups();
  void append(const Bytes& part) { body.insert(body.end(), part.begin(), part.end()); }
};

ChunkEncoder::ChunkEncoder() : s_(std::make_unique<Scratch>()) {}
ChunkEncoder::~ChunkEncoder() = default;

// Palette and patterns, in the order of first appearance.
void ChunkEncoder::Scratch::put_patterns(const RayBlock& b, const SetTable& sets) {
  palette.clear();
  Bytes& patterns = gaps;
  patterns.clear();
  put_varint(patterns, b.patterns.size());
  for (uint32_t p = 0; p < b.patterns.size(); ++p) {
    put_varint(patterns, b.patterns.changes(p));
    for (const SetId set : b.patterns.sets(p)) {
      auto it = std::ranges::find(palette, set);
      if (it == palette.end()) it = palette.insert(it, set);
      put_varint(patterns, it - palette.begin());
    }
  }
  put_varint(body, palette.size());
  for (const SetId set : palette) put_set(body, sets.members(set));
  append(patterns);
}

// The pattern of each ray: exceptions to the prediction.
void ChunkEncoder::Scratch::put_exceptions(const RayBlock& b) {
  gaps.clear();
  exceptions.clear();
  uint64_t count = 0;
  uint32_t next = 0;  // the ray after the last exception
  for (uint32_t v = 0; v < b.nv; ++v) {
    const auto row = b.pattern.begin() + ptrdiff_t{v} * b.nu;
    if (v > 0 && std::equal(row, row + b.nu, row - b.nu)) continue;  // each is as expected
    for (uint32_t u = 0, ray = v * b.nu; u < b.nu; ++u, ++ray) {
      if (b.pattern[ray] == expected_pattern(b.pattern, b.nu, u, v)) continue;
      put_varint(gaps, ray - next);
      put_varint(exceptions, b.pattern[ray]);
      next = ray + 1;
      ++count;
    }
  }
  put_varint(body, count);
  append(gaps);
  append(exceptions);
}

// The changes: residuals of the plane as bytes, everything else as varints.
void ChunkEncoder::Scratch::put_changes(const RayBlock& b) {
  narrow.resize(b.at.size() + kGroup + sizeof(uint64_t));  // as many at most, and put_groups() reads on
  narrow_bytes = 0;
  wide.clear();
  const auto one = [&](uint32_t ray, From from) {
    const uint32_t* at = b.at.data() + b.begin[ray];
    const uint32_t n = b.begin[ray + 1] - b.begin[ray];
    const uint32_t* like = b.at.data() + b.begin[from == From::kUp ? ray - b.nu : ray - (from == From::kLeft)];
    for (uint32_t i = 0; i < n; ++i) {
      if (from == From::kNothing) put_varint(wide, at[i] - (i == 0 ? 0 : at[i - 1]) - 1);
      else put_varint(wide, zigzag(static_cast<int32_t>(at[i] - like[i])));
    }
  };
  const auto plane = [&](uint32_t from, uint32_t to) {
    const uint32_t n = b.begin[from + 1] - b.begin[from], rays = to - from, size = n * rays;
    const uint32_t* at = b.at.data() + b.begin[from];
    const uint32_t* up = b.at.data() + b.begin[from - b.nu];
    if (along.size() < size) along.resize(size);
    uint8_t* const out = narrow.data() + narrow_bytes;
    narrow_bytes += size;
    uint8_t* const in_turn = n == 1 ? out : along.data();
    const auto residual_of = [](const uint32_t* change, const uint32_t* above, uint32_t changes, uint32_t i) TERACELL_IN_LINE {
      return zigzag(static_cast<int32_t>(change[i] - (change - changes)[i] - above[i] + (above - changes)[i]));
    };
    uint32_t widest = 0;
    on_vector_unit([&]() TERACELL_IN_LINE {
      const uint32_t *const change = at, *const above = up, changes = n, end = size, count = rays;
      uint8_t* __restrict const bytes = in_turn, * __restrict const first = out, * __restrict const second = out + count;
      uint32_t most = 0;
      for (uint32_t i = 0; i < end; ++i) {
        const uint32_t r = residual_of(change, above, changes, i);
        most = std::max(most, r);
        bytes[i] = static_cast<uint8_t>(std::min<uint32_t>(r, kEscape));
      }
      widest = most;
      // The residuals of one change after those of the other. Most rays have two, and a stride that the compiler knows is one for vectors.
      if (changes == 2)
        for (size_t ray = 0; ray < count; ++ray) first[ray] = bytes[2 * ray], second[ray] = bytes[2 * ray + 1];
    });
    if (n > 2)
      for (uint32_t change = 0; change < n; ++change)
        for (uint32_t ray = 0; ray < rays; ++ray) out[change * rays + ray] = along[ray * n + change];
    if (widest < kEscape) return;
    for (uint32_t change = 0; change < n; ++change)
      for (uint32_t i = change; i < size; i += n)
        if (const uint32_t r = residual_of(at, up, n, i); r >= kEscape) put_varint(wide, r - kEscape);
  };
  walk(b, one, plane);
  put_groups();
  append(wide);
}

// The narrow residuals, five in a byte. Those of a group are the low bytes of a word: adding 125 to each shows whether it is above 2, and of a
// product with powers of 3 in its bytes the fifth byte is the sum that is wanted. No byte of it overflows.
void ChunkEncoder::Scratch::put_groups() {
  constexpr uint64_t kOfGroup = (uint64_t{1} << (8 * kGroup)) - 1, kPowers = 0x01'03'09'1b'51;
  const size_t groups = (narrow_bytes + kGroup - 1) / kGroup, start = body.size();
  std::fill_n(narrow.data() + narrow_bytes, groups * kGroup - narrow_bytes, uint8_t{0});
  spelled.clear();
  body.resize(start + groups);
  uint8_t* const out = body.data() + start;
  const uint8_t* r = narrow.data();
  for (size_t i = 0; i < groups; ++i, r += kGroup) {
    const uint64_t digits = fixed_at<uint64_t>(r) & kOfGroup;
    const bool small = (((digits + 0x7d7d7d7d7d) | digits) & 0x8080808080) == 0;
    if (!small) spelled.insert(spelled.end(), r, r + kGroup);
    out[i] = small ? static_cast<uint8_t>(digits * kPowers >> 32) : kSpelled;
  }
  append(spelled);
}

Bytes ChunkEncoder::encode(const RayBlock& b, const SetTable& sets) {
  Scratch& s = *s_;
  s.body.assign(1, kInGroups);
  s.put_patterns(b, sets);
  s.put_exceptions(b);
  s.put_changes(b);
  if (s.body.size() > kMaxChunkBytes || b.at.size() > kMaxChunkChanges)
    throw InputError(fmt::format("a chunk of {} x {} rays has {} changes of material, more than one can hold: the surface is too fine for it", b.nu,
                                 b.nv, b.at.size()));
  return s.zstd.encode(s.body, kZstdLevel, kChunkBound);
}

}  // namespace teracell::store
