// The leaves that begin in a block of 64 x 64 x 64 cells, and which of them holds a cell.
#pragma once
#include <array>
#include <optional>
#include <vector>

#include "store/refine/leaves.hpp"

namespace teracell::exports {

// The bits of a number below 64, each followed by two zeros.
inline constexpr std::array<uint32_t, 64> kSpreadBits = [] {
  std::array<uint32_t, 64> out{};
  for (uint32_t i = 0; i < 64; ++i)
    for (uint32_t bit = 0; bit < 6; ++bit) out[i] |= (i >> bit & 1) << (3 * bit);
  return out;
}();
// The Morton code of a cell within its block.
inline uint32_t code_in_block(const Index3& cell) {
  return kSpreadBits[static_cast<size_t>(cell[0] & 63)] | kSpreadBits[static_cast<size_t>(cell[1] & 63)] << 1 |
         kSpreadBits[static_cast<size_t>(cell[2] & 63)] << 2;
}

// How many bits of a byte are set.
inline constexpr std::array<uint8_t, 256> kOnes = [] {
  std::array<uint8_t, 256> out{};
  for (size_t i = 1; i < 256; ++i) out[i] = static_cast<uint8_t>(out[i / 2] + i % 2);
  return out;
}();

// The leaves that begin in a block, in Morton order.
struct LeafBlock {
  static constexpr int kBits = 6;
  static constexpr uint32_t kNotInMesh = ~uint32_t{0};

  Index3 at;                     // of the block
  std::optional<Subtree> cover;  // the leaf that holds the block and more
  // For each 2 x 2 x 2 cells as large as the finest leaf, by Morton code: a bit for each cell that is the first of a leaf, and how many leaves
  // begin before them.
  struct Eight {
    uint32_t before = 0;
    uint8_t starts = 0;
  };
  std::vector<Eight> eights;
  uint32_t shift = 0;  // from the codes of cells of level 0 to theirs
  struct Leaf {
    uint32_t number;  // among the block's leaves in the mesh
    uint32_t code : 24, level : 8;  // of the first cell
    Label label;
    uint32_t material;
  };
  std::vector<Leaf> leaves;
  std::vector<uint32_t> region;  // of each leaf in the mesh, among those of the block; empty where regions don't matter
  uint32_t in_mesh = 0;          // how many
  int64_t first = 0;             // number of the first of these in the mesh

  size_t size() const { return leaves.size(); }
  // The leaf that holds a cell of the block: the last one that begins there or before it. REQUIRES: it is in the box, and there is no cover.
  uint32_t find(const Index3& cell) const {
    const uint32_t code_here = code_in_block(cell) >> shift;
    const Eight& eight = eights[code_here / 8];
    return eight.before + kOnes[eight.starts & (0xFF >> (7 - code_here % 8))] - 1;
  }
  size_t memory() const;
  Index3 first_cell(uint32_t i) const;
};

}  // namespace teracell::exports
