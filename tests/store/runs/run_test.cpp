// Blocks of rays: what was appended is there, and cut and join move cells without changing them.
#include "store/runs/run.hpp"

#include "tests/support/blocks.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using namespace testing;

TEST_CASE("Patterns get ids in the order of their first appearance") {
  PatternTable table;
  std::vector<std::vector<SetId>> patterns;
  for (SetId a = 0; a < 40; ++a)
    for (SetId b = 0; b < 40; ++b)
      if (a != b) patterns.push_back({a, b, a + 1});
  patterns.push_back({7});
  for (int round = 0; round < 2; ++round)
    for (uint32_t i = 0; i < patterns.size(); ++i) REQUIRE(table.intern(patterns[i]) == i);
  REQUIRE(table.size() == patterns.size());
  for (uint32_t i = 0; i < patterns.size(); ++i) {
    REQUIRE(same(table.sets(i), patterns[i]));
    REQUIRE(table.changes(i) == patterns[i].size() - 1);
  }
  table.clear();
  REQUIRE(table.size() == 0);
  REQUIRE(table.intern(patterns[5]) == 0);
}

TEST_CASE("Appended rays come back as their runs") {
  RayBlock block;
  block.reset(2, 2, 10);
  block.append(std::array<SetId, 1>{3}, {});
  block.append(std::array<SetId, 3>{0, 1, 0}, std::array<uint32_t, 2>{1, 9});
  block.append(std::array<SetId, 1>{3}, {});
  block.append(std::array<SetId, 2>{1, 0}, std::array<uint32_t, 1>{4});
  REQUIRE(block.pattern == std::vector<uint32_t>{0, 1, 0, 2});
  REQUIRE(expand(block, SetTable(4)) == std::vector<Mask>{8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 1, 2, 2, 2, 2, 2, 2, 2, 2, 1,  //
                                                          8, 8, 8, 8, 8, 8, 8, 8, 8, 8, 2, 2, 2, 2, 1, 1, 1, 1, 1, 1});
  REQUIRE_FALSE(block.uniform());
}

TEST_CASE("A filled block is uniform, one with a second set or a change is not") {
  RayBlock block;
  block.fill(3, 2, 7, 1);
  REQUIRE(block.uniform());
  REQUIRE(expand(block, SetTable(2)) == std::vector<Mask>(42, 2));
  block.reset(2, 1, 7);
  block.append(std::array<SetId, 1>{0}, {});
  REQUIRE(block.uniform());
  block.append(std::array<SetId, 1>{1}, {});
  REQUIRE_FALSE(block.uniform());
  block.reset(1, 1, 7);
  block.append(std::array<SetId, 2>{0, 1}, std::array<uint32_t, 1>{3});
  REQUIRE_FALSE(block.uniform());
}

TEST_CASE("A block that was used before gives no sign of it") {
  std::mt19937_64 random(3);
  Chunk used = random_chunk(random, BlockKind::kDifferent, 9, 9, 50, 5);
  used.rays.reset(2, 1, 4);
  used.rays.append(std::array<SetId, 2>{0, 1}, std::array<uint32_t, 1>{3});
  used.rays.append(std::array<SetId, 2>{0, 1}, std::array<uint32_t, 1>{1});
  REQUIRE(broken_invariant(used, 2, 1, 4, 5) == "");
  REQUIRE(used.rays.patterns.size() == 1);
}

TEST_CASE("A cut holds the cells of its stretch of every ray") {
  std::mt19937_64 random(4);
  for (const BlockKind kind : kAllKinds) {
    const Chunk whole = random_chunk(random, kind, 6, 5, 40, 4);
    const std::vector<Mask> cells = expand(whole);
    for (uint32_t from = 0; from < 40; from += 3) {
      for (uint32_t to = from + 1; to <= 40; ++to) {
        Chunk part{cut(whole.rays, from, to), whole.sets};
        std::vector<Mask> expected;
        for (uint32_t ray = 0; ray < 30; ++ray) expected.insert(expected.end(), cells.begin() + ray * 40 + from, cells.begin() + ray * 40 + to);
        REQUIRE(broken_invariant(part, 6, 5, to - from, 4) == "");
        REQUIRE(expand(part) == expected);
      }
    }
  }
}

TEST_CASE("Pieces join to the block they were taken from, however it was divided and their ids were made") {
  std::mt19937_64 random(5);
  const uint32_t nu = 11, nv = 7, length = 30;
  for (const BlockKind kind : kAllKinds) {
    const Chunk whole = random_chunk(random, kind, nu, nv, length, 6);
    const std::vector<Mask> cells = expand(whole);
    for (int round = 0; round < 10; ++round) {
      const uint32_t step_u = static_cast<uint32_t>(random_int(random, 1, 12)), step_v = static_cast<uint32_t>(random_int(random, 1, 8)),
                     step_w = static_cast<uint32_t>(random_int(random, 1, 31));
      std::vector<Chunk> parts;
      std::vector<Piece> pieces;
      parts.reserve(nu * nv * length);
      for (uint32_t w = 0; w < length; w += step_w)
        for (uint32_t v = 0; v < nv; v += step_v)
          for (uint32_t u = 0; u < nu; u += step_u) {
            const uint32_t u1 = std::min(u + step_u, nu), v1 = std::min(v + step_v, nv), w1 = std::min(w + step_w, length);
            std::vector<Mask> part;
            for (uint32_t y = v; y < v1; ++y)
              for (uint32_t x = u; x < u1; ++x)
                part.insert(part.end(), cells.begin() + (y * nu + x) * length + w, cells.begin() + (y * nu + x) * length + w1);
            parts.push_back(block_of_cells(u1 - u, v1 - v, w1 - w, 6, part));
            pieces.push_back({u, v, w, &parts.back()});
          }
      std::ranges::shuffle(pieces, random);
      const Chunk joined = join(pieces, 6);
      REQUIRE(broken_invariant(joined, nu, nv, length, 6) == "");
      REQUIRE(expand(joined) == cells);
      REQUIRE(same_runs(joined, whole));
    }
  }
}

}  // namespace
}  // namespace teracell
