// Coarser levels against unions taken cell by cell.
#include "store/runs/pyramid.hpp"

#include "store/grid/grid.hpp"
#include "tests/support/blocks.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using namespace testing;

std::vector<Mask> coarse_by_hand(const Chunk& fine, int shift) {
  const RayBlock& b = fine.rays;
  const auto half = [&](uint32_t n) { return static_cast<size_t>(ceil_shift(n, shift)); };
  std::vector<Mask> out(half(b.nu) * half(b.nv) * half(b.length), 0);
  const std::vector<Mask> cells = expand(fine);
  size_t i = 0;
  for (uint32_t v = 0; v < b.nv; ++v)
    for (uint32_t u = 0; u < b.nu; ++u)
      for (uint32_t w = 0; w < b.length; ++w) out[((v >> shift) * half(b.nu) + (u >> shift)) * half(b.length) + (w >> shift)] |= cells[i++];
  return out;
}

void expect_exact(const Chunk& fine) {
  for (const int shift : {1, 2}) {
    INFO("shift " << shift << ", " << fine.rays.nu << " x " << fine.rays.nv << " rays of " << fine.rays.length << " cells");
    const Chunk found = coarsen(fine, shift);
    const auto part = [&](uint32_t n) { return static_cast<uint32_t>(ceil_shift(n, shift)); };
    REQUIRE(broken_invariant(found, part(fine.rays.nu), part(fine.rays.nv), part(fine.rays.length), fine.sets.labels()) == "");
    REQUIRE(expand(found) == coarse_by_hand(fine, shift));
    uint32_t patterns = 0;  // are numbered as they appear, and each of them does
    for (const uint32_t pattern : found.rays.pattern) {
      REQUIRE(pattern <= patterns);
      patterns += pattern == patterns;
    }
    REQUIRE(patterns == found.rays.patterns.size());
  }
  REQUIRE(same_runs(coarsen(fine, 2), coarsen(coarsen(fine, 1), 1)));
}

TEST_CASE("A coarse cell has exactly the labels below it, for random blocks of any size") {
  std::mt19937_64 random(1);
  for (int round = 0; round < 40; ++round)
    for (const BlockKind kind : kAllKinds) {
      INFO("round " << round << ", kind " << static_cast<int>(kind));
      const auto size = [&](int most) { return static_cast<uint32_t>(random_int(random, 1, most)); };
      expect_exact(random_chunk(random, kind, size(11), size(11), size(50), 5));
    }
}

TEST_CASE("Blocks of sets, as a level above the first is, coarsen to the unions of the sets") {
  std::mt19937_64 random(2);
  for (int round = 0; round < 40; ++round) {
    const Chunk fine = random_chunk(random, BlockKind::kSets, 9, 7, 40, 8);
    expect_exact(fine);
    expect_exact(coarsen(fine, 1));
  }
}

TEST_CASE("Rays of one pattern whose runs lie far apart leave the cells between them as they are") {
  std::mt19937_64 random(3);
  const std::vector<SetId> pattern = {0, 1, 0, 2, 1, 0};
  for (int round = 0; round < 300; ++round) {
    Chunk fine{{}, SetTable(3)};
    fine.rays.reset(4, 4, 60);
    for (int ray = 0; ray < 16; ++ray) {  // all runs short, at a place of their own on every ray
      uint32_t at = static_cast<uint32_t>(random_int(random, 1, 30));
      std::vector<uint32_t> changes;
      for (size_t i = 0; i + 1 < pattern.size(); ++i, at += static_cast<uint32_t>(random_int(random, 1, 5))) changes.push_back(at);
      fine.rays.append(pattern, changes);
    }
    expect_exact(fine);
  }
}

TEST_CASE("A sheet one cell thick, and a single cell, never vanish") {
  for (uint32_t w = 0; w < 13; ++w) {
    std::vector<Mask> cells(7 * 5 * 13, 1);
    for (size_t ray = 0; ray < 35; ++ray) cells[ray * 13 + w] = 2;
    expect_exact(block_of_cells(7, 5, 13, 2, cells));
    std::fill(cells.begin(), cells.end(), 1);
    cells[(w % 35) * 13 + w] = 2;
    expect_exact(block_of_cells(7, 5, 13, 2, cells));
  }
}

TEST_CASE("A uniform block stays uniform") {
  for (const uint32_t size : {1u, 2u, 3u, 4u, 5u, 64u}) {
    Chunk fine{{}, SetTable(4)};
    const SetId pair = fine.sets.intern({1, 3});
    fine.rays.fill(size, size, size, pair);
    expect_exact(fine);
    REQUIRE(coarsen(fine, 2).rays.uniform());
  }
}

TEST_CASE("Rays of the largest length coarsen without overflow") {
  Chunk fine{{}, SetTable(2)};
  const uint32_t length = (uint32_t{1} << 31) - 2;
  fine.rays.reset(2, 1, length);
  fine.rays.append(std::array<SetId, 2>{0, 1}, std::array{length - 1});
  fine.rays.append(std::array<SetId, 3>{0, 1, 0}, std::array{1u, length - 1});
  const Chunk found = coarsen(fine, 2);
  REQUIRE(broken_invariant(found, 1, 1, 1u << 29, 2) == "");
  REQUIRE(found.sets.members(found.rays.sets(0)[0]) == std::vector<Label>{0, 1});
  REQUIRE(found.rays.changes(0).empty());
}

}  // namespace
}  // namespace teracell
