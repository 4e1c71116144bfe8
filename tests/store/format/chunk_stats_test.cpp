// The statistics of a chunk against counting its cells.
#include "store/format/chunk_stats.hpp"

#include "tests/support/blocks.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using namespace testing;

std::vector<LabelStats> by_counting(const Chunk& chunk) {
  std::map<Label, LabelStats> all;
  size_t i = 0;
  const std::vector<Mask> cells = expand(chunk);
  for (uint32_t v = 0; v < chunk.rays.nv; ++v)
    for (uint32_t u = 0; u < chunk.rays.nu; ++u)
      for (uint32_t w = 0; w < chunk.rays.length; ++w) {
        const auto label = static_cast<Label>(__builtin_ctzll(cells[i++]));
        LabelStats& s = all.try_emplace(label, LabelStats{label, 0, {u, v, w}, {u, v, w}}).first->second;
        s.cells += 1;
        const std::array<uint32_t, 3> cell = {u, v, w};
        for (size_t d = 0; d < 3; ++d) s.lo[d] = std::min(s.lo[d], cell[d]), s.hi[d] = std::max(s.hi[d], cell[d] + 1);
      }
  std::vector<LabelStats> out;
  for (const auto& [label, s] : all) out.push_back(s);
  return out;
}

TEST_CASE("Every label of a block has its cells and its box, labels ascending") {
  std::mt19937_64 random(31);
  for (const BlockKind kind : {BlockKind::kSmooth, BlockKind::kNoise, BlockKind::kDifferent, BlockKind::kJagged})  // one label per cell
    for (int round = 0; round < 20; ++round) {
      const auto size = [&] { return static_cast<uint32_t>(random_int(random, 1, 20)); };
      const uint32_t nu = size(), nv = size(), length = size() + 4;
      INFO("kind " << static_cast<int>(kind) << ", " << nu << " x " << nv << " rays of " << length);
      const Chunk chunk = random_chunk(random, kind, nu, nv, length, 5);
      REQUIRE(stats_of(chunk.rays) == by_counting(chunk));
    }
}

TEST_CASE("A block of one label fills its box") {
  RayBlock block;
  block.fill(3, 2, 7, 4);
  REQUIRE(stats_of(block) == std::vector<LabelStats>{{4, 42, {0, 0, 0}, {3, 2, 7}}});
}

}  // namespace
}  // namespace teracell
