// The leaves of a refined grid by place: which leaf holds a cell, and which number it has in a mesh. Blocks of 64 x 64 x 64 cells are made when they
// are asked for, and kept for a while, so memory does not grow with the grid.
#pragma once
#include <algorithm>
#include <unordered_map>

#include "tools/export/refined/refined.hpp"

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

// Which leaves are cells of the mesh, and where they are cut off.
struct MeshOfLeaves {
  Box box;                     // of level-0 cells
  std::vector<bool> in_mesh;   // by material
};

class LeafGrid {
 public:
  // Keeps references to both.
  LeafGrid(const RefinedGrid& refined, const MeshOfLeaves& mesh);

  const Box& box() const { return mesh_.box; }
  const RefinedGrid& refined() const { return refined_; }
  std::shared_ptr<const LeafBlock> block(const Index3& at) const;
  // Takes all cells out of the mesh but those of its largest region: cells that touch through faces. Of equally large ones, the first.
  void keep_largest_region(const std::function<void(double share)>& progress);
  // Gives numbers to the mesh's cells, in Morton order. see() is called for each block in which leaves begin, in this order.
  void number(const std::function<void(double share)>& progress, const std::function<void(const LeafBlock&)>& see);
  int64_t cells() const { return cells_; }
  // Makes something of each block in which leaves begin, on all threads, and takes it in Morton order.
  template <class Make, class Take>
  void for_each_block(const std::function<void(double share)>& progress, Make&& make, Take&& take) const;

 private:
  std::shared_ptr<LeafBlock> make(const Index3& at) const;

  const RefinedGrid& refined_;
  const MeshOfLeaves& mesh_;
  struct PlaceHash {
    size_t operator()(const Index3& at) const {
      return ChunkKeyHash{}({0, static_cast<uint32_t>(at[0]), static_cast<uint32_t>(at[1]), static_cast<uint32_t>(at[2])});
    }
  };
  int64_t cells_ = 0;
  enum class Regions { kIgnored, kSought, kFound } regions_ = Regions::kIgnored;
  std::unordered_map<Index3, uint32_t, PlaceHash> first_region_;  // of a block's regions, among those of all blocks
  std::vector<bool> kept_;                                        // by region
  std::unordered_map<Index3, int64_t, PlaceHash> first_;  // number of a block's first cell; blocks without cells are missing
  mutable LruCache<Index3, LeafBlock, PlaceHash> blocks_;
};

// A leaf of a grid, cut to the box of the mesh.
struct LeafAt {
  const LeafBlock* block = nullptr;  // null: none
  uint32_t i = 0;
  int level = 0;
  Index3 first{};  // cell, which may lie outside of the box
  const Box* cut = nullptr;

  explicit operator bool() const { return block != nullptr; }
  bool in_mesh() const { return block->leaves[i].number != LeafBlock::kNotInMesh; }
  int64_t number() const { return block->first + block->leaves[i].number; }
  uint32_t material() const { return block->leaves[i].material; }
  int64_t lo(size_t d) const { return std::max(first[d], cut->lo[d]); }
  int64_t hi(size_t d) const { return std::min(first[d] + (int64_t{1} << level), cut->hi[d]); }
  Index3 lower() const { return {lo(0), lo(1), lo(2)}; }
  bool has_corner(const Index3& p) const {
    for (size_t d = 0; d < 3; ++d)
      if (p[d] != lo(d) && p[d] != hi(d)) return false;
    return true;
  }
  // Where finer neighbours meet on an axis, if that is within the leaf.
  std::optional<int64_t> half(size_t axis) const {
    if (level == 0) return std::nullopt;
    const int64_t at = first[axis] + (int64_t{1} << (level - 1));
    return at > lo(axis) && at < hi(axis) ? std::optional(at) : std::nullopt;
  }
};

// Looks leaves up around a block. Not thread-safe.
class NearLeaves {
 public:
  NearLeaves(const LeafGrid& grid, const Index3& block) : grid_(grid), box_(grid.box()), centre_(block) {}

  // None outside the box.
  LeafAt at(const Index3& cell) {
    for (size_t d = 0; d < 3; ++d)
      if (cell[d] < box_.lo[d] || cell[d] >= box_.hi[d]) return {};
    const LeafBlock* b = &block(shifted_down(cell));
    if (b->cover) {
      b = &block(shifted_down(b->cover->first()));
      return leaf(*b, 0);
    }
    const uint32_t i = b->find(cell);
    const int level = b->leaves[i].level;
    return {b, i, level, {cell[0] >> level << level, cell[1] >> level << level, cell[2] >> level << level}, &box_};
  }
  // The leaf that holds the lowest cell beside a leaf across its upper or lower side on an axis.
  LeafAt beside(const LeafAt& leaf, size_t axis, bool up) {
    if (leaf.level == 0 && (leaf.first[axis] & 1) == (up ? 0 : 1)) {
      // Mostly one of the same eight, which follow each other.
      const uint32_t code = leaf.block->leaves[leaf.i].code;
      if (leaf.block->eights[code / 8].starts == 0xFF) {
        Index3 first = leaf.first;
        first[axis] += up ? 1 : -1;
        return {leaf.block, up ? leaf.i + (1U << axis) : leaf.i - (1U << axis), 0, first, &box_};
      }
    }
    Index3 next = leaf.lower();
    next[axis] = up ? leaf.hi(axis) : leaf.lo(axis) - 1;
    return at(next);
  }
  LeafAt leaf(const LeafBlock& block, uint32_t i) const { return {&block, i, static_cast<int>(block.leaves[i].level), block.first_cell(i), &box_}; }
  // Those around a point, by octant: bit d is set where the leaf lies above it on axis d.
  using Around = std::array<LeafAt, 8>;
  Around around(const Index3& p) {
    Around out;
    for (size_t o = 0; o < 8; ++o)
      out[o] = at({p[0] - 1 + static_cast<int64_t>(o & 1), p[1] - 1 + static_cast<int64_t>(o >> 1 & 1), p[2] - 1 + static_cast<int64_t>(o >> 2)});
    return out;
  }

 private:
  static Index3 shifted_down(const Index3& cell) { return {cell[0] >> LeafBlock::kBits, cell[1] >> LeafBlock::kBits, cell[2] >> LeafBlock::kBits}; }

  const LeafBlock& block(const Index3& at) {
    const int64_t u = at[0] - centre_[0] + 1, v = at[1] - centre_[1] + 1, w = at[2] - centre_[2] + 1;
    if (u < 0 || u > 2 || v < 0 || v > 2 || w < 0 || w > 2) return far(at);
    auto& near = near_[static_cast<size_t>((w * 3 + v) * 3 + u)];
    if (!near) near = grid_.block(at);
    return *near;
  }
  const LeafBlock& far(const Index3& at);

  const LeafGrid& grid_;
  const Box& box_;
  const Index3 centre_;
  std::array<std::shared_ptr<const LeafBlock>, 27> near_;
  std::vector<std::shared_ptr<const LeafBlock>> far_;
};

}  // namespace teracell::exports

#include "store/base/in_order.hpp"

namespace teracell::exports {

template <class Make, class Take>
void LeafGrid::for_each_block(const std::function<void(double share)>& progress, Make&& make, Take&& take) const {
  Leaves::Walk walk(refined_.leaves(), mesh_.box, LeafBlock::kBits);
  const auto size = static_cast<double>(std::max<int64_t>(1, mesh_.box.hi[2] - mesh_.box.lo[2]));
  in_order(
      refined_.threads(),
      [&]() -> std::optional<Index3> {
        const auto s = walk.next();
        if (!s) return std::nullopt;
        Index3 at = s->first();
        progress(std::clamp(static_cast<double>(at[2] - mesh_.box.lo[2]) / size, 0.0, 1.0));
        for (int64_t& a : at) a >>= LeafBlock::kBits;
        return at;
      },
      [&](const Index3& at, int) { return make(at); }, take, 4);
}

}  // namespace teracell::exports
