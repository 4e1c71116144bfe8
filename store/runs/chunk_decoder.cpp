#include <algorithm>

#include <fmt/format.h>

#include "store/runs/chunk_walk.hpp"

namespace teracell::inline store {

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

// The loops that take time are functions of their own: browsers compile one function after the other, and small ones soon (web/module).
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

[[gnu::noinline]] void decode_changes(ByteReader& in, RayBlock& b) {
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
  if (!valid) in.clause("11.4"), in.fail("the changes of a ray must ascend within it");
}

}  // namespace

void ChunkDecoder::decode(std::span<const uint8_t> frame, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, Chunk& out) {
  if (uint64_t{nu} * nv > kMaxChunkRays)
    throw FormatError(fmt::format("a chunk of {} x {} rays is larger than a file may have (FORMAT.md 7.6)", nu, nv));
  Scratch& s = *s_;
  s.zstd.decode(frame, kChunkBound, "chunk", s.body);

  ByteReader in(s.body, "chunk", "11.1");
  out.rays.reset(nu, nv, length);
  out.sets = SetTable(labels);
  decode_palette(in, out.sets, s.palette);
  decode_patterns(in, out.rays, s.palette, s.sets);
  decode_pattern_of_rays(in, out.rays);
  in.clause("11.3");
  decode_changes(in, out.rays);
  in.expect_end();
}

}  // namespace teracell::store
