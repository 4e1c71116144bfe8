// Sums of many tiles' overlaps, in memory and on disk, against a map.
#include "mesher/overlaps/overlap_sum.hpp"

#include "tests/support/meshed.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;
using Pairs = std::map<std::array<uint32_t, 2>, Overlap>;

void add(Pairs& pairs, const Overlap& overlap) {
  if (const auto [pair, is_new] = pairs.try_emplace(overlap.bodies, overlap); !is_new) pair->second.add(overlap);
}

Overlap random_overlap(std::mt19937_64& random, int bodies) {
  Overlap out;
  const int b = random_int(random, 1, bodies - 1);
  out.bodies = {static_cast<uint32_t>(random_int(random, 0, b - 1)), static_cast<uint32_t>(b)};
  out.third = random_int(random, 0, 1) == 0;
  out.cells = static_cast<unsigned __int128>(random()) << random_int(random, 0, 20);
  for (int d = 0; d < 3; ++d) {
    out.box.lo[d] = random_int(random, 0, 1 << 30);
    out.box.hi[d] = out.box.lo[d] + random_int(random, 1, 1 << 20);
    out.at[d] = random_int(random, static_cast<int>(out.box.lo[d]), static_cast<int>(out.box.hi[d]) - 1);
  }
  return out;
}

Pairs random_tile(std::mt19937_64& random, int bodies, int most) {
  Pairs out;
  for (int i = random_int(random, 0, most); i > 0; --i) add(out, random_overlap(random, bodies));
  return out;
}

Bytes packed(const Pairs& pairs) {
  OverlapPacker packer;
  for (const auto& [bodies, overlap] : pairs) packer.put(overlap);
  return packer.take();
}

std::vector<Overlap> all_of(const OverlapSum& sum) {
  std::vector<Overlap> out;
  sum.for_each([&](const Overlap& o) { out.push_back(o); });
  return out;
}

std::vector<Overlap> all_of(const Pairs& pairs) {
  std::vector<Overlap> out;
  for (const auto& [bodies, overlap] : pairs) out.push_back(overlap);
  return out;
}

OverlapSum saved_and_restored(const OverlapSum& sum) {
  Bytes bytes;
  sum.save(bytes);
  ByteReader in(bytes, "saved");
  OverlapSum out = OverlapSum::restored(in);
  in.expect_end();
  return out;
}

}  // namespace

TEST_CASE("Of overlaps of the same bodies the cells add up, the boxes are joined, and the place is the lowest by z, then y, then x", "[overlaps]") {
  Overlap o{{0, 1}, false, 3, {{4, 4, 4}, {5, 5, 7}}, {4, 4, 4}};
  o.add({{0, 1}, true, 1, {{9, 0, 4}, {10, 1, 5}}, {9, 0, 4}});
  CHECK(o == Overlap{{0, 1}, true, 4, {{4, 0, 4}, {10, 5, 7}}, {9, 0, 4}});
}

TEST_CASE("A sum has each pair once, whatever the tiles, their order, and how often it was saved or copied meanwhile", "[overlaps]") {
  for (uint64_t seed = 0; seed < rounds(30); ++seed) {
    std::mt19937_64 random(seed);
    Pairs expected;
    OverlapSum sum, other;
    const int bodies = random_int(random, 2, 200);
    for (int tile = random_int(random, 0, 60); tile > 0; --tile) {
      const Pairs pairs = random_tile(random, bodies, 300);
      for (const auto& [key, overlap] : pairs) add(expected, overlap);
      (random_int(random, 0, 3) == 0 ? other : sum).add(packed(pairs));
      if (random_int(random, 0, 20) == 0) sum = saved_and_restored(sum);
    }
    const OverlapSum copy = sum;
    sum.add(other);
    REQUIRE(all_of(sum) == all_of(expected));
    REQUIRE(all_of(saved_and_restored(sum)) == all_of(expected));
    other.add(copy);
    REQUIRE(all_of(other) == all_of(expected));
  }
}

TEST_CASE("What outgrows the memory goes to disk, and the sum is the same", "[overlaps]") {
  const TempFolder folder;
  std::mt19937_64 random(7);
  OverlapSum bounded, unbounded;
  bounded.bound({1, folder.path()});
  for (int tile = 0; tile < (kSanitized ? 12 : 60); ++tile) {
    const Bytes bytes = packed(random_tile(random, 1000, 20'000));
    bounded.add(Bytes(bytes));
    unbounded.add(Bytes(bytes));
  }
  REQUIRE(bounded.on_disk() > (kSanitized ? 1 : 4) << 20);
  REQUIRE(unbounded.on_disk() == 0);
  const auto expected = all_of(unbounded);
  REQUIRE(all_of(bounded) == expected);
  OverlapSum copy = bounded, sum;
  copy.add(Bytes(packed(random_tile(random, 1000, 20'000))));
  REQUIRE(all_of(bounded) == expected);
  REQUIRE(all_of(saved_and_restored(bounded)) == expected);
  sum.add(bounded);
  REQUIRE(all_of(sum) == expected);
}

TEST_CASE("Bytes that no sum has saved are a format error, or say something else", "[overlaps]") {
  std::mt19937_64 random(3);
  OverlapSum sum;
  sum.add(packed(random_tile(random, 20, 50)));
  Bytes good;
  sum.save(good);
  for (size_t size = 0; size < good.size(); ++size) {
    const Bytes cut(good.begin(), good.begin() + static_cast<ptrdiff_t>(size));
    ByteReader in(cut, "cut");
    CHECK_THROWS_AS(OverlapSum::restored(in), FormatError);
  }
  for (size_t at = 0; at < good.size(); ++at) {
    Bytes bad = good;
    bad[at] ^= static_cast<uint8_t>(random_int(random, 1, 255));
    ByteReader in(bad, "bad");
    try {
      for (const Overlap& o : all_of(OverlapSum::restored(in))) REQUIRE_FALSE(o.box.empty());
    } catch (const FormatError&) {  // is as good
    }
  }
  OverlapPacker twice;  // a block that begins anew with the same bodies
  twice.put(random_overlap(random, 2));
  const Bytes block = twice.take();
  Bytes bad;
  for (int i = 0; i < 2; ++i) {
    put_varint(bad, block.size());
    bad.insert(bad.end(), block.begin(), block.end());
  }
  put_varint(bad, 0);
  ByteReader in(bad, "bad");
  CHECK_THROWS_WITH(all_of(OverlapSum::restored(in)), Catch::Contains("ascend"));
}

}  // namespace teracell::mesher
