// Blocks of rays for the tests of the store: drawn at random, and written out cell by cell.
#pragma once
#include <string>

#include "store/runs/run.hpp"
#include "tests/support/random.hpp"

namespace teracell::testing {

// A set of labels below 64 as bits, for oracles that go cell by cell.
using Mask = uint64_t;
Mask mask_of(const std::vector<Label>& set);

enum class BlockKind {
  kSmooth,     // a body with a smooth surface and a core, rays that miss both
  kNoise,      // every third cell differs from the one before it
  kDifferent,  // no two rays alike
  kSets,       // the same with sets of several labels
  kJagged,     // one pattern, changes anywhere: no neighbour predicts them
};
inline constexpr BlockKind kAllKinds[] = {BlockKind::kSmooth, BlockKind::kNoise, BlockKind::kDifferent, BlockKind::kSets, BlockKind::kJagged};

Chunk random_chunk(std::mt19937_64& random, BlockKind kind, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels);

// The sets of all cells, a ray after the other.
std::vector<Mask> expand(const RayBlock& rays, const SetTable& sets);
inline std::vector<Mask> expand(const Chunk& chunk) { return expand(chunk.rays, chunk.sets); }
// Rays with the given cells, in the same order.
Chunk block_of_cells(uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels, const std::vector<Mask>& cells);

// The same runs of the same sets, whatever the ids.
bool same_runs(const Chunk& a, const Chunk& b);
// What is wrong with a chunk of this shape by the invariants of run.hpp; empty if nothing.
std::string broken_invariant(const Chunk& chunk, uint32_t nu, uint32_t nv, uint32_t length, uint32_t labels);

}  // namespace teracell::testing
