// Chunks to bytes and back; and bytes that no encoder wrote.
#include "store/runs/chunk_codec.hpp"

#include <sys/resource.h>

#include "store/format/format.hpp"
#include "store/runs/chunk_walk.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/every_way.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using namespace testing;

Bytes encoded(const Chunk& chunk) { return ChunkEncoder().encode(chunk.rays, chunk.sets); }

struct Shape {
  uint32_t nu, nv, length, labels;
};

Chunk decoded(std::span<const uint8_t> frame, const Shape& s) {
  Chunk out;
  ChunkDecoder().decode(frame, s.nu, s.nv, s.length, s.labels, out);
  return out;
}

void expect_round_trip(const Chunk& chunk) {
  const Shape s{chunk.rays.nu, chunk.rays.nv, chunk.rays.length, chunk.sets.labels()};
  const Bytes frame = encoded(chunk);
  const Chunk back = decoded(frame, s);
  REQUIRE(broken_invariant(back, s.nu, s.nv, s.length, s.labels) == "");
  REQUIRE(same_runs(back, chunk));
  REQUIRE(encoded(back) == frame);
}

// Decodes bytes that may be anything: a FormatError, or rays that keep every promise of run.hpp.
void expect_refused_or_sound(ChunkDecoder& decoder, const Bytes& bytes, const Shape& s) {
  const Bytes exact(bytes.begin(), bytes.end());  // its own piece of the heap, so that ASan sees one byte too far
  Chunk out;
  try {
    decoder.decode(exact, s.nu, s.nv, s.length, s.labels, out);
  } catch (const FormatError&) {
    return;
  }
  const std::string broken = broken_invariant(out, s.nu, s.nv, s.length, s.labels);
  if (!broken.empty()) FAIL(broken);
}

// ---- bodies by hand: everything that knows the layout stands here ---------------------------------------------------

Bytes frame_of(const std::vector<uint64_t>& numbers) {
  Bytes body;
  for (const uint64_t n : numbers) put_varint(body, n);
  return encode_text({body.begin(), body.end()});
}

// The body of a chunk as format 2 has it (FORMAT.md 11.7). All sets of the table are in the palette.
Bytes before_groups(const Chunk& chunk) {
  const RayBlock& b = chunk.rays;
  Bytes body, gaps, exceptions, narrow, wide;
  put_varint(body, chunk.sets.ids());
  for (SetId set = 0; set < chunk.sets.ids(); ++set) put_set(body, chunk.sets.members(set));
  put_varint(body, b.patterns.size());
  for (uint32_t p = 0; p < b.patterns.size(); ++p) {
    put_varint(body, b.patterns.changes(p));
    for (const SetId set : b.patterns.sets(p)) put_varint(body, set);
  }
  uint64_t count = 0;
  for (uint32_t ray = 0, next = 0; ray < b.rays(); ++ray)
    if (b.pattern[ray] != expected_pattern(b.pattern, b.nu, ray % b.nu, ray / b.nu)) {
      put_varint(gaps, ray - next), put_varint(exceptions, b.pattern[ray]);
      next = ray + 1, ++count;
    }
  const auto put_wide = [&](uint32_t difference) { put_varint(wide, zigzag(static_cast<int32_t>(difference))); };
  walk(
      b,
      [&](uint32_t ray, From from) {
        for (uint32_t i = 0; i < b.changes(ray).size(); ++i) {
          const uint32_t at = b.changes(ray)[i];
          if (from == From::kNothing) put_varint(wide, at - (i == 0 ? 0 : b.changes(ray)[i - 1]) - 1);
          else put_wide(at - b.changes(from == From::kUp ? ray - b.nu : ray - 1)[i]);
        }
      },
      [&](uint32_t from, uint32_t to) {
        for (uint32_t ray = from; ray < to; ++ray)
          for (uint32_t i = 0; i < b.changes(ray).size(); ++i) {
            const uint32_t plane = b.changes(ray - 1)[i] + b.changes(ray - b.nu)[i] - b.changes(ray - b.nu - 1)[i];
            const uint32_t residual = zigzag(static_cast<int32_t>(b.changes(ray)[i] - plane));
            narrow.push_back(static_cast<uint8_t>(std::min(residual, 255u)));
            if (residual >= 255) put_varint(wide, residual - 255);
          }
      });
  put_varint(body, count);
  for (const Bytes* part : {&gaps, &exceptions, &narrow, &wide}) body.insert(body.end(), part->begin(), part->end());
  return encode_text({body.begin(), body.end()});
}

// The body of 2 x 1 rays of 8 cells with labels below 3: 0 | 1 from cell 3 on, then the same from cell 5 on. As format 2 has it.
struct HandMade {
  std::vector<uint64_t> palette = {2, 1, 0, 1, 1};  // two sets: {0}, {1}
  std::vector<uint64_t> patterns = {1, 1, 0, 1};    // one pattern with one change: set 0, set 1
  std::vector<uint64_t> exceptions = {0};
  std::vector<uint64_t> changes = {2, 4};           // 3 = 2 + 1; 5 = 3 + unzigzag(4)

  Bytes frame() const {
    std::vector<uint64_t> all = palette;
    for (const auto* part : {&patterns, &exceptions, &changes}) all.insert(all.end(), part->begin(), part->end());
    return frame_of(all);
  }
};
constexpr Shape kHandMadeShape{2, 1, 8, 3};

// A zstd frame that claims `content` bytes and consists of `blocks` runs of 128 KiB zero bytes, 4 bytes each.
Bytes bomb(uint64_t content, uint32_t blocks) {
  Bytes out;
  put_fixed<uint32_t>(out, 0xFD2FB528);
  out.push_back(0xE0);  // one segment, content size in 8 bytes
  put_fixed(out, content);
  for (uint32_t i = 0; i < blocks; ++i) {
    const uint32_t header = (128u << 10 << 3) | 1u << 1 | (i + 1 == blocks);
    for (int b = 0; b < 3; ++b) out.push_back(static_cast<uint8_t>(header >> (8 * b)));
    out.push_back(0);
  }
  return out;
}

// ---- sound chunks ---------------------------------------------------------------------------------------------------

TEST_CASE("Random blocks of every kind and shape come back as they were") {
  std::mt19937_64 random(1);
  for (const BlockKind kind : kAllKinds) {
    for (const Shape& s :
         {Shape{1, 1, 1, 3}, {1, 1, 2, 3}, {5, 1, 40, 3}, {1, 5, 40, 3}, {4, 4, 1, 3}, {7, 5, 2, 3}, {64, 64, 100, 5}, {13, 64, 257, 60}}) {
      INFO("kind " << static_cast<int>(kind) << ", " << s.nu << " x " << s.nv << " rays of " << s.length << " cells");
      expect_round_trip(random_chunk(random, kind, s.nu, s.nv, s.length, s.labels));
    }
  }
}

TEST_CASE("Chunks of format 2 are read") {
  std::mt19937_64 random(11);
  for (const BlockKind kind : kAllKinds)
    for (const uint32_t length : {60u, (1u << 31) - 2}) {
      if (length > 60 && (kind == BlockKind::kNoise || kind == BlockKind::kSets)) continue;
      const Chunk chunk = random_chunk(random, kind, 40, 20, length, 5);
      INFO("kind " << static_cast<int>(kind) << ", rays of " << length << " cells");
      REQUIRE(same_runs(decoded(before_groups(chunk), {40, 20, length, 5}), chunk));
    }
}

TEST_CASE("The largest chunk, 256 x 256 rays, comes back as it was") {
  std::mt19937_64 random(2);
  expect_round_trip(random_chunk(random, BlockKind::kSmooth, 256, 256, 300, 3));
  expect_round_trip(random_chunk(random, BlockKind::kDifferent, 256, 256, 300, 3));
}

TEST_CASE("Rows of more rays than are decoded at once come back as they were, on each vector unit") {
  for (const VectorUnit unit : {VectorUnit::kPlain, VectorUnit::kAvx2, VectorUnit::kAvx512}) {
    const OnVectorUnit on(unit);
    std::mt19937_64 random(12);
    for (const BlockKind kind : kAllKinds) expect_round_trip(random_chunk(random, kind, 3000, 3, kind == BlockKind::kJagged ? 20000 : 40, 3));
  }
}

TEST_CASE("Rays of two billion cells with changes anywhere come back as they were") {
  std::mt19937_64 random(3);
  const uint32_t length = (uint32_t{1} << 31) - 2;
  expect_round_trip(random_chunk(random, BlockKind::kJagged, 20, 20, length, 3));  // residuals that pass 32 bits
  expect_round_trip(random_chunk(random, BlockKind::kDifferent, 20, 20, length, 3));
  expect_round_trip(random_chunk(random, BlockKind::kSmooth, 64, 64, length, 3));
}

TEST_CASE("Residuals around the largest byte come back as they were, whatever the number of changes and wherever one jumps") {
  for (uint32_t n = 1; n <= 6; ++n)
    for (int64_t jump = n == 1 ? -1030 : -140; jump <= (n == 1 ? 1030 : 140); ++jump) {
      Chunk chunk{{}, SetTable(2)};
      chunk.rays.reset(11, 2, 20000);
      std::vector<SetId> sets = {0};
      for (uint32_t k = 1; k <= n; ++k) sets.push_back(k % 2);
      for (uint32_t ray = 0; ray < 22; ++ray) {
        std::vector<uint32_t> at;
        for (uint32_t k = 1; k <= n; ++k) at.push_back(3000 * k + ray % 11 * k);
        const auto place = static_cast<uint32_t>(jump + 1030) % (9 * n);  // in the second row, from its third ray on
        if (ray == 13 + place / n) at[place % n] += static_cast<uint32_t>(jump);
        chunk.rays.append(sets, at);
      }
      const Chunk back = decoded(encoded(chunk), {11, 2, 20000, 2});
      if (!same_runs(back, chunk)) FAIL("a residual of " << jump << " among " << n << " changes");
    }
}

TEST_CASE("Thousands of labels, and sets of all of them, come back as they were") {
  const uint32_t labels = 5000;
  Chunk chunk{{}, SetTable(labels)};
  chunk.rays.reset(10, 10, 200);
  std::mt19937_64 random(4);
  std::vector<Label> everything(labels);
  for (Label l = 0; l < labels; ++l) everything[l] = l;
  const SetId all = chunk.sets.intern(everything);
  for (int ray = 0; ray < 100; ++ray) {
    std::vector<SetId> sets = {all};
    std::vector<uint32_t> at;
    for (uint32_t w = 1; w < 200; ++w) {
      const auto label = static_cast<SetId>(random() % labels);
      const SetId next = random() % 50 == 0 ? all : label;
      if (next != sets.back()) sets.push_back(next), at.push_back(w);
    }
    chunk.rays.append(sets, at);
  }
  expect_round_trip(chunk);
}

TEST_CASE("Equal cells give equal bytes, whatever the encoder did before and whatever the ids are") {
  std::mt19937_64 random(5);
  ChunkEncoder used;
  for (const BlockKind kind : kAllKinds) {
    const Chunk chunk = random_chunk(random, kind, 16, 12, 50, 5);
    const Chunk other = random_chunk(random, BlockKind::kNoise, 20, 20, 30, 5);
    used.encode(other.rays, other.sets);
    const Chunk again = block_of_cells(16, 12, 50, 5, expand(chunk));
    REQUIRE(used.encode(chunk.rays, chunk.sets) == encoded(again));
  }
}

TEST_CASE("A decoder that met a damaged chunk decodes the next one") {
  std::mt19937_64 random(6);
  const Chunk chunk = random_chunk(random, BlockKind::kSets, 8, 8, 30, 5);
  const Bytes frame = encoded(chunk);
  ChunkDecoder decoder;
  Chunk out;
  REQUIRE_THROWS_AS(decoder.decode(std::span(frame).first(frame.size() / 2), 8, 8, 30, 5, out), FormatError);
  decoder.decode(frame, 8, 8, 30, 5, out);
  REQUIRE(same_runs(out, chunk));
}

// ---- damaged and hostile chunks -------------------------------------------------------------------------------------

TEST_CASE("A chunk cut short at any byte is refused, and so is one with a byte too many") {
  std::mt19937_64 random(7);
  ChunkDecoder decoder;
  for (const BlockKind kind : kAllKinds) {
    Bytes frame = encoded(random_chunk(random, kind, 8, 8, 30, 5));
    Chunk out;
    for (size_t n = 0; n < frame.size(); ++n) {
      const Bytes cut(frame.begin(), frame.begin() + static_cast<ptrdiff_t>(n));
      REQUIRE_THROWS_AS(decoder.decode(cut, 8, 8, 30, 5, out), FormatError);
    }
    frame.push_back(0);
    REQUIRE_THROWS_AS(decoder.decode(frame, 8, 8, 30, 5, out), FormatError);
  }
}

TEST_CASE("A chunk body cut short at any byte, or with a byte too many, is refused") {
  std::mt19937_64 random(8);
  ChunkDecoder decoder;
  for (const BlockKind kind : kAllKinds) {
    std::string body = decode_text(encoded(random_chunk(random, kind, 8, 8, 30, 5)), "chunk");
    Chunk out;
    for (size_t n = 0; n < body.size(); ++n) REQUIRE_THROWS_AS(decoder.decode(encode_text(body.substr(0, n)), 8, 8, 30, 5, out), FormatError);
    REQUIRE_THROWS_AS(decoder.decode(encode_text(body + '\0'), 8, 8, 30, 5, out), FormatError);
  }
}

TEST_CASE("A chunk with any bit flipped, in the frame or in the body, is refused or keeps every invariant") {
  std::mt19937_64 random(9);
  ChunkDecoder decoder;
  for (const BlockKind kind : kAllKinds) {
    const Shape s{6, 6, 30, 5};
    Bytes frame = encoded(random_chunk(random, kind, s.nu, s.nv, s.length, s.labels));
    for (size_t bit = 0; bit < 8 * frame.size(); ++bit) {
      frame[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
      expect_refused_or_sound(decoder, frame, s);
      frame[bit / 8] ^= static_cast<uint8_t>(1u << bit % 8);
    }
    std::string body = decode_text(frame, "chunk");
    for (size_t bit = 0; bit < 8 * body.size(); ++bit) {
      body[bit / 8] = static_cast<char>(body[bit / 8] ^ 1 << bit % 8);
      expect_refused_or_sound(decoder, encode_text(body), s);
      body[bit / 8] = static_cast<char>(body[bit / 8] ^ 1 << bit % 8);
    }
  }
}

TEST_CASE("A chunk read with another shape than it was written with is refused or keeps every invariant") {
  std::mt19937_64 random(10);
  ChunkDecoder decoder;
  const Bytes frame = encoded(random_chunk(random, BlockKind::kDifferent, 8, 8, 30, 5));
  for (const uint32_t nu : {1u, 7u, 8u, 9u, 256u})
    for (const uint32_t nv : {1u, 7u, 8u, 9u, 256u})
      for (const uint32_t length : {1u, 2u, 29u, 31u, (1u << 31) - 2})
        for (const uint32_t labels : {1u, 2u, 4u, 1000u}) expect_refused_or_sound(decoder, frame, {nu, nv, length, labels});
  Chunk out;
  REQUIRE_THROWS_AS(decoder.decode(frame, 257, 256, 30, 5, out), FormatError);
  REQUIRE_THROWS_AS(decoder.decode(frame, 1u << 31, 1u << 31, 30, 5, out), FormatError);
}

TEST_CASE("Numbers in a chunk that lie are refused") {
  const Chunk honest = decoded(HandMade().frame(), kHandMadeShape);
  REQUIRE(expand(honest) == std::vector<Mask>{1, 1, 1, 2, 2, 2, 2, 2, 1, 1, 1, 1, 1, 2, 2, 2});

  const uint64_t huge = uint64_t{1} << 60;
  const auto refused = [](const char* what, auto&& edit) {
    HandMade body;
    edit(body);
    INFO(what);
    REQUIRE_THROWS_AS(decoded(body.frame(), kHandMadeShape), FormatError);
  };
  refused("an empty palette", [](HandMade& b) { b.palette = {0}; });
  refused("a palette larger than the body", [&](HandMade& b) { b.palette = {huge}; });
  refused("an empty set", [](HandMade& b) { b.palette = {2, 0, 1, 1}; });
  refused("a set larger than the number of labels", [&](HandMade& b) { b.palette = {2, huge, 0, 1, 1}; });
  refused("a label that is not there", [](HandMade& b) { b.palette = {2, 1, 0, 1, 3}; });
  refused("a label that is not there, by its difference", [](HandMade& b) { b.palette = {2, 1, 0, 2, 1, 1}; });
  refused("a label that passes 64 bits", [](HandMade& b) { b.palette = {2, 1, 0, 2, 1, ~uint64_t{0}}; });
  refused("no pattern", [](HandMade& b) { b.patterns = {0}; });
  refused("more patterns than rays", [](HandMade& b) { b.patterns = {3, 1, 0, 1, 0, 0, 0, 1}; });
  refused("a pattern that occurs twice", [](HandMade& b) { b.patterns = {2, 1, 0, 1, 1, 0, 1}; });
  refused("a pattern that repeats a set", [](HandMade& b) { b.patterns = {1, 1, 1, 1}; });
  refused("two places of the palette that hold one set, side by side in a pattern", [](HandMade& b) { b.palette = {2, 1, 0, 1, 0}; });
  refused("a palette index that is not there", [](HandMade& b) { b.patterns = {1, 1, 0, 2}; });
  refused("more changes than a ray has cells", [](HandMade& b) { b.patterns = {1, 8, 0, 1, 0, 1, 0, 1, 0, 1, 0}; });
  refused("changes without bytes", [&](HandMade& b) { b.patterns = {1, huge, 0, 1}; });
  refused("more exceptions than rays", [&](HandMade& b) { b.exceptions = {huge}; });
  refused("an exception beyond the last ray", [](HandMade& b) { b.exceptions = {1, 2, 0}; });
  refused("an exception whose pattern is not there", [](HandMade& b) { b.exceptions = {1, 0, 1}; });
  refused("a change at the ray's end", [](HandMade& b) { b.changes = {7, 0}; });
  refused("a change beyond 32 bits", [&](HandMade& b) { b.changes = {huge, 0}; });
  refused("a change that wraps to the first cell", [](HandMade& b) { b.changes = {0xFFFFFFFF, 0}; });
  refused("a change before the ray", [](HandMade& b) { b.changes = {2, 5}; });
  refused("a change missing", [](HandMade& b) { b.changes = {2}; });
  refused("a number too many", [](HandMade& b) { b.changes = {2, 4, 0}; });
}

TEST_CASE("A group of residuals may be spelled, and one that lies is refused") {
  // 2 x 2 rays: the first changes at cell 10, the next two are like it, and the last is planar.
  const auto last_of = [](const Bytes& groups_and_spelled, const Bytes& wide = {9, 0, 0}) {
    Bytes body = {0, 2, 1, 0, 1, 1, 1, 1, 0, 1, 0};
    for (const Bytes* part : {&groups_and_spelled, &wide}) body.insert(body.end(), part->begin(), part->end());
    return decoded(encode_text({body.begin(), body.end()}), {2, 2, 1000, 3}).rays.at.back();
  };
  REQUIRE(last_of({0}) == 10);
  REQUIRE(last_of({1}) == 9);
  REQUIRE(last_of({2}) == 11);
  REQUIRE(last_of({243, 2, 0, 0, 0, 0}) == 11);
  REQUIRE(last_of({243, 254, 0, 0, 0, 0}) == 137);
  REQUIRE(last_of({243, 255, 0, 0, 0, 0}, {9, 0, 0, 1}) == 138);
  for (const Bytes& lies :
       {Bytes{244}, Bytes{255}, Bytes{3}, Bytes{243, 0, 0, 0, 0, 1}, Bytes{243, 0}, Bytes{243, 255, 0, 0, 0, 0}, Bytes{}, Bytes{0, 0}})
    REQUIRE_THROWS_AS(last_of(lies), FormatError);
}

TEST_CASE("A frame that claims more than its bytes can hold is refused without memory for the claim") {
  const auto peak_kib = [] {
    rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss;
  };
  const long before = peak_kib();
  for (const uint64_t content : {uint64_t{1} << 28, (uint64_t{1} << 28) + 1, uint64_t{1} << 40, ~uint64_t{0} - 1})
    REQUIRE_THROWS_AS(decoded(bomb(content, 1), kHandMadeShape), FormatError);
  REQUIRE_THROWS_AS(decoded(bomb((uint64_t{1} << 28) + (128 << 10), 2049), kHandMadeShape), FormatError);  // true, but beyond the format
  REQUIRE(peak_kib() - before < 64 * 1024);
}

TEST_CASE("A bomb of megabytes of zeros is not a chunk") {
  REQUIRE_THROWS_AS(decoded(bomb(16u << 20, 128), kHandMadeShape), FormatError);
  REQUIRE_THROWS_AS(decoded(bomb(15u << 20, 128), kHandMadeShape), FormatError);  // and it lies about its size
  REQUIRE_THROWS_AS(decoded(encode_text(std::string(100'000, '\1')), {256, 256, 1000, 3}), FormatError);
}

TEST_CASE("What is not a zstd frame, or not just one, is refused") {
  const Bytes sound = HandMade().frame();
  REQUIRE_THROWS_AS(decoded({}, kHandMadeShape), FormatError);
  REQUIRE_THROWS_AS(decoded(Bytes(100, 0), kHandMadeShape), FormatError);
  const Bytes skippable = {0x5E, 0x2A, 0x4D, 0x18, 4, 0, 0, 0, 1, 2, 3, 4};
  REQUIRE_THROWS_AS(decoded(skippable, kHandMadeShape), FormatError);
  for (const Bytes& second : {sound, skippable}) {
    Bytes two = sound;
    two.insert(two.end(), second.begin(), second.end());
    REQUIRE_THROWS_AS(decoded(two, kHandMadeShape), FormatError);
  }
}

}  // namespace
}  // namespace teracell
