#include "store/chunk_codec.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/zstd_frame.hpp"

namespace teracell {
namespace {

constexpr int kZstdLevel = 1;     // 3 gains 2 %, 9 gains 6 % for five times the time
constexpr BodyBound kChunkBound = {kMaxChunkBytes, kChunkBytesOfAnyFrame};
constexpr uint8_t kEscape = 255;  // a narrow residual whose value stands in the wide stream

uint32_t zigzag(int32_t v) { return (static_cast<uint32_t>(v) << 1) ^ static_cast<uint32_t>(v >> 31); }
int32_t unzigzag(uint32_t v) { return static_cast<int32_t>(v >> 1) ^ -static_cast<int32_t>(v & 1); }

// The pattern expected at (u, v) from the rays before it. If the left neighbour has the pattern of the ray above it, this
// ray probably has that of the ray above it, too. Otherwise it probably has that of the left neighbour.
uint32_t expected_pattern(const std::vector<uint32_t>& pattern, uint32_t nu, uint32_t u, uint32_t v) {
  const uint32_t ray = v * nu + u;
  if (v == 0) return u == 0 ? 0 : pattern[ray - 1];
  if (u == 0) return pattern[ray - nu];
  return pattern[ray - 1] == pattern[ray - nu - 1] ? pattern[ray - nu] : pattern[ray - 1];
}

// Which neighbours predict the changes of a ray: those with as many changes.
enum class From { kNothing, kLeft, kUp, kPlane };

From predictor(const RayBlock& b, uint32_t u, uint32_t v) {
  const uint32_t ray = v * b.nu + u;
  const auto count = [&](uint32_t r) { return b.begin[r + 1] - b.begin[r]; };
  const uint32_t n = count(ray);
  const bool left = u > 0 && count(ray - 1) == n, up = v > 0 && count(ray - b.nu) == n;
  if (left && up) return count(ray - b.nu - 1) == n ? From::kPlane : From::kLeft;
  return left ? From::kLeft : up ? From::kUp : From::kNothing;
}

// Calls one(ray, predictor) for the rays with changes that the plane does not predict, and plane(from, to) for the longest
// stretches of a row that it does predict, in order. Encoder and decoder walk a block with this.
template <class One, class Plane>
void walk(const RayBlock& b, One&& one, Plane&& plane) {
  for (uint32_t v = 0; v < b.nv; ++v) {
    for (uint32_t u = 0; u < b.nu;) {
      const uint32_t ray = v * b.nu + u;
      const uint32_t n = b.begin[ray + 1] - b.begin[ray];
      if (n == 0) {
        ++u;
        continue;
      }
      const From from = predictor(b, u, v);
      if (from != From::kPlane) {
        one(ray, from);
        ++u;
        continue;
      }
      uint32_t end = u + 1;  // within the stretch, the left and the upper left neighbours match by themselves
      while (end < b.nu && b.begin[v * b.nu + end + 1] - b.begin[v * b.nu + end] == n &&
             b.begin[(v - 1) * b.nu + end + 1] - b.begin[(v - 1) * b.nu + end] == n)
        ++end;
      plane(ray, v * b.nu + end);
      u = end;
    }
  }
}

}  // namespace

// ---- encoding ---------------------------------------------------------------------------------------------------

struct ChunkEncoder::Scratch {
  ZstdEncoder zstd;
  Bytes body, gaps, exceptions, narrow, wide;
  std::vector<SetId> palette;

  void put_patterns(const RayBlock& b, const SetTable& sets);
  void put_exceptions(const RayBlock& b);
  void put_changes(const RayBlock& b);
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
  for (uint32_t v = 0, ray = 0; v < b.nv; ++v) {
    for (uint32_t u = 0; u < b.nu; ++u, ++ray) {
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
  narrow.clear();
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
    const uint32_t n = b.begin[from + 1] - b.begin[from], size = b.begin[to] - b.begin[from];
    const uint32_t* at = b.at.data() + b.begin[from];
    const uint32_t* up = b.at.data() + b.begin[from - b.nu];
    const size_t start = narrow.size();
    narrow.resize(start + size);
    uint8_t* out = narrow.data() + start;
    const auto residual = [&](uint32_t i) { return zigzag(static_cast<int32_t>(at[i] - (at - n)[i] - up[i] + (up - n)[i])); };
    uint32_t widest = 0;
    for (uint32_t i = 0; i < size; ++i) {
      const uint32_t r = residual(i);
      widest = std::max(widest, r);
      out[i] = static_cast<uint8_t>(std::min<uint32_t>(r, kEscape));
    }
    if (widest < kEscape) return;
    for (uint32_t i = 0; i < size; ++i)
      if (out[i] == kEscape) put_varint(wide, residual(i) - kEscape);
  };
  walk(b, one, plane);
  append(narrow);
  append(wide);
}

Bytes ChunkEncoder::encode(const RayBlock& b, const SetTable& sets) {
  Scratch& s = *s_;
  s.body.clear();
  s.put_patterns(b, sets);
  s.put_exceptions(b);
  s.put_changes(b);
  if (s.body.size() > kMaxChunkBytes)
    throw InputError(
        fmt::format("a chunk of {} x {} rays has {} changes of material, more than fit in {} MiB: the surface is finer than the chunks can hold",
                    b.nu, b.nv, b.at.size(), kMaxChunkBytes >> 20));
  return s.zstd.encode(s.body, kZstdLevel, kChunkBound);
}

// ---- decoding ---------------------------------------------------------------------------------------------------

struct ChunkDecoder::Scratch {
  ZstdDecoder zstd;
  Bytes body;
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

void decode_pattern_of_rays(ByteReader& in, RayBlock& b) {
  const uint64_t count = in.varint(0, std::min<uint64_t>(b.rays(), in.remaining() / 2), "exceptions");
  std::vector<std::pair<uint32_t, uint32_t>> exceptions(count);  // ray, pattern
  uint64_t next = 0;
  for (auto& [ray, pattern] : exceptions) {
    next += in.varint(0, b.rays(), "gap");
    if (next >= b.rays()) in.fail("an exception lies beyond the last ray");
    ray = static_cast<uint32_t>(next++);
  }
  for (auto& [ray, pattern] : exceptions) pattern = static_cast<uint32_t>(in.varint(0, b.patterns.size() - 1, "pattern"));

  b.pattern.resize(b.rays());
  b.begin.resize(b.rays() + 1);
  uint64_t changes = 0;
  auto exception = exceptions.begin();
  for (uint32_t v = 0, ray = 0; v < b.nv; ++v) {
    for (uint32_t u = 0; u < b.nu; ++u, ++ray) {
      b.begin[ray] = static_cast<uint32_t>(changes);
      if (exception != exceptions.end() && exception->first == ray) b.pattern[ray] = exception++->second;
      else b.pattern[ray] = expected_pattern(b.pattern, b.nu, u, v);
      changes += b.patterns.changes(b.pattern[ray]);
      if (changes > in.remaining()) in.fail("the rays have more changes than the chunk has bytes");  // also keeps 32 bits
    }
  }
  b.begin[b.rays()] = static_cast<uint32_t>(changes);
}

void decode_changes(ByteReader& in, RayBlock& b) {
  b.at.resize(b.begin.back());
  uint64_t planar = 0;
  walk(
      b, [](uint32_t, From) {}, [&](uint32_t from, uint32_t to) { planar += b.begin[to] - b.begin[from]; });
  const uint8_t* narrow = in.take(planar).data();

  const auto one = [&](uint32_t ray, From from) {
    uint32_t* at = b.at.data() + b.begin[ray];
    const uint32_t n = b.begin[ray + 1] - b.begin[ray];
    const uint32_t* like = b.at.data() + b.begin[from == From::kUp ? ray - b.nu : ray - (from == From::kLeft)];
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t wide = static_cast<uint32_t>(in.varint(0, ~0u, "change"));
      at[i] = from == From::kNothing ? (i == 0 ? 0 : at[i - 1]) + wide + 1 : like[i] + unzigzag(wide);
    }
  };
  const auto plane = [&](uint32_t from, uint32_t to) {
    const uint32_t n = b.begin[from + 1] - b.begin[from], size = b.begin[to] - b.begin[from];
    uint32_t* at = b.at.data() + b.begin[from];
    const uint32_t* up = b.at.data() + b.begin[from - b.nu];
    for (uint32_t i = 0; i < size; ++i) {
      uint32_t r = narrow[i];
      if (r == kEscape) r += static_cast<uint32_t>(in.varint(0, ~0u - kEscape, "residual"));
      at[i] = (at - n)[i] + up[i] - (up - n)[i] + unzigzag(r);
    }
    narrow += size;
  };
  walk(b, one, plane);

  bool valid = true;
  for (uint32_t ray = 0; ray < b.rays(); ++ray) {
    uint32_t least = 0;
    for (uint32_t i = b.begin[ray]; i < b.begin[ray + 1]; ++i) {
      valid &= b.at[i] > least;
      least = b.at[i];
    }
    valid &= least < b.length;
  }
  if (!valid) in.fail("the changes of a ray must ascend within it");
}

}  // namespace

void ChunkDecoder::decode(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, Chunk& out) {
  if (uint64_t{nu} * nv > kMaxChunkRays) throw FormatError(fmt::format("a chunk of {} x {} rays is larger than FORMAT.md allows", nu, nv));
  Scratch& s = *s_;
  s.zstd.decode(frame, kChunkBound, "chunk", s.body);

  ByteReader in(s.body, "chunk");
  out.rays.reset(nu, nv, length);
  out.sets = SetTable(labels);
  decode_palette(in, out.sets, s.palette);
  decode_patterns(in, out.rays, s.palette, s.sets);
  decode_pattern_of_rays(in, out.rays);
  decode_changes(in, out.rays);
  in.expect_end();
}

}  // namespace teracell
