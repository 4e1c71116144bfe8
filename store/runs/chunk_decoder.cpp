#include <algorithm>
#include <array>
#include <cstring>

#include <fmt/format.h>

#include "store/runs/chunk_walk.hpp"

namespace teracell::inline store {

struct ChunkDecoder::Scratch {
  ZstdDecoder zstd;
  Bytes body, narrow;
  std::vector<SetId> palette, sets;
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
[[gnu::noinline]] void decode_pattern_of_rays(ByteReader& in, RayBlock& b, bool in_groups) {
  const uint64_t count = in.varint(0, std::min<uint64_t>(b.rays(), in.remaining() / 2), "exceptions");
  std::vector<std::pair<uint32_t, uint32_t>> exceptions(count);  // ray, pattern
  uint64_t next = 0;
  for (auto& [ray, pattern] : exceptions) {
    next += in.varint(0, b.rays(), "gap");
    if (next >= b.rays()) in.fail("an exception lies beyond the last ray");
    ray = static_cast<uint32_t>(next++);
  }
  for (auto& [ray, pattern] : exceptions) pattern = static_cast<uint32_t>(in.varint(0, b.patterns.size() - 1, "pattern"));

  const uint64_t most =
      std::min<uint64_t>(kMaxChunkChanges, uint64_t{in.remaining()} * (in_groups ? kGroup : 1));  // that the bytes can hold; also keeps 32 bits
  b.pattern.resize(b.rays());
  b.begin.resize(b.rays() + 1);
  const auto check = [&](uint64_t changes) {
    if (changes > most) in.fail("the rays have more changes than the chunk has bytes for");
  };
  uint64_t changes = 0;
  auto exception = exceptions.begin();
  for (uint32_t v = 0, ray = 0; v < b.nv; ++v) {
    if (v > 0 && (exception == exceptions.end() || exception->first >= ray + b.nu)) {  // the row is as the one above it
      const uint32_t above = ray - b.nu, further = static_cast<uint32_t>(changes) - b.begin[above];
      check(changes + further);
      for (uint32_t u = 0; u < b.nu; ++u, ++ray) {
        b.pattern[ray] = b.pattern[above + u];
        b.begin[ray] = b.begin[above + u] + further;
      }
      changes += further;
      continue;
    }
    for (uint32_t u = 0; u < b.nu; ++u, ++ray) {
      b.begin[ray] = static_cast<uint32_t>(changes);
      if (exception != exceptions.end() && exception->first == ray) b.pattern[ray] = exception++->second;
      else b.pattern[ray] = expected_pattern(b.pattern, b.nu, u, v);
      check(changes += b.patterns.changes(b.pattern[ray]));
    }
  }
  b.begin[b.rays()] = static_cast<uint32_t>(changes);
}

// The digits of each group, filled up to eight bytes, which are copied as one.
constexpr auto kDigits = [] {
  std::array<std::array<uint8_t, 8>, kSpelled> out{};
  for (uint32_t group = 0; group < kSpelled; ++group)
    for (uint32_t i = 0, rest = group; i < kGroup; ++i, rest /= 3) out[group][i] = static_cast<uint8_t>(rest % 3);
  return out;
}();

// Narrow residuals from their groups.
[[gnu::noinline]] void decode_groups(ByteReader& in, uint64_t count, Bytes& narrow) {
  const std::span<const uint8_t> groups = in.take((count + kGroup - 1) / kGroup);
  uint64_t spelled = 0;
  uint8_t largest = 0;
  for (const uint8_t group : groups) {
    spelled += group == kSpelled;
    largest = std::max(largest, group);
  }
  if (largest > kSpelled) in.fail(fmt::format("a group of residuals must be at most {}, found {}", kSpelled, largest));
  const uint8_t* in_full = in.take(kGroup * spelled).data();
  narrow.resize(kGroup * groups.size() + sizeof kDigits[0]);
  uint8_t* out = narrow.data();
  for (const uint8_t group : groups) {
    if (group < kSpelled) {
      std::memcpy(out, kDigits[group].data(), sizeof kDigits[group]);
    } else {
      std::memcpy(out, in_full, kGroup);
      in_full += kGroup;
    }
    out += kGroup;
  }
  for (uint64_t i = count; i < kGroup * groups.size(); ++i)
    if (narrow[i] != 0) in.fail("the last group of residuals must end with zeros");
}

[[gnu::noinline]] void decode_changes(ByteReader& in, RayBlock& b, bool in_groups, Bytes& scratch) {
  b.at.resize(b.begin.back());
  uint64_t planar = 0;
  walk(
      b, [](uint32_t, From) {}, [&](uint32_t from, uint32_t to) { planar += b.begin[to] - b.begin[from]; });
  if (in_groups) decode_groups(in, planar, scratch);
  const uint8_t* narrow = in_groups ? scratch.data() : in.take(planar).data();

  const auto one = [&](uint32_t ray, From from) {
    uint32_t* at = b.at.data() + b.begin[ray];
    const uint32_t n = b.begin[ray + 1] - b.begin[ray];
    const uint32_t* like = b.at.data() + b.begin[from == From::kUp ? ray - b.nu : ray - (from == From::kLeft)];
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t wide = static_cast<uint32_t>(in.varint(0, ~0u, "change"));
      at[i] = from == From::kNothing ? (i == 0 ? 0 : at[i - 1]) + wide + 1 : like[i] + unzigzag(wide);
    }
  };
  const auto next = [&] {
    uint32_t r = *narrow++;
    if (r == kEscape) r += static_cast<uint32_t>(in.varint(0, ~0u - kEscape, "residual"));
    return static_cast<uint32_t>(unzigzag(r));
  };
  // One change of each of some rays, which have n changes each.
  const auto along = [&](uint32_t* at, const uint32_t* up, uint32_t n, uint32_t rays) {
    uint32_t left = *(at - n), above = *(up - n);
    for (; rays > 0; --rays, at += n, up += n) {
      left += *up - above + next();
      above = *up;
      *at = left;
    }
  };
  const auto plane = [&](uint32_t from, uint32_t to) {
    const uint32_t n = b.begin[from + 1] - b.begin[from], size = b.begin[to] - b.begin[from];
    uint32_t* at = b.at.data() + b.begin[from];
    const uint32_t* up = b.at.data() + b.begin[from - b.nu];
    if (in_groups)
      for (uint32_t change = 0; change < n; ++change) along(at + change, up + change, n, to - from);
    else
      for (uint32_t i = 0; i < size; ++i) at[i] = (at - n)[i] + up[i] - (up - n)[i] + next();
  };
  walk(b, one, plane);

  bool valid = true;
  for (uint32_t v = 0, ray = 0; v < b.nv; ++v) {
    if (changes_of_all(b, v) == 2) {  // most rows; without a branch, so that vectors do it
      const uint32_t* at = b.at.data() + b.begin[ray];
      uint32_t wrong = 0;
      for (size_t i = 0; i < size_t{2} * b.nu; i += 2) wrong |= (at[i] == 0) | (at[i] >= at[i + 1]) | (at[i + 1] >= b.length);
      valid &= wrong == 0;
      ray += b.nu;
      continue;
    }
    for (const uint32_t end = ray + b.nu; ray < end; ++ray) {
      uint32_t least = 0;
      for (uint32_t i = b.begin[ray]; i < b.begin[ray + 1]; ++i) {
        valid &= b.at[i] > least;
        least = b.at[i];
      }
      valid &= least < b.length;
    }
  }
  if (!valid) in.clause("11.4"), in.fail("the changes of a ray must ascend within it");
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
  const bool in_groups = !s.body.empty() && s.body.front() == kInGroups;
  if (in_groups) in.take(1);
  decode_palette(in, out.sets, s.palette);
  decode_patterns(in, out.rays, s.palette, s.sets);
  decode_pattern_of_rays(in, out.rays, in_groups);
  in.clause("11.3");
  decode_changes(in, out.rays, in_groups, s.narrow);
  in.expect_end();
}

}  // namespace teracell::store
