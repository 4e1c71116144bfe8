// The leaves of a refined grid by place: which leaf holds a cell, and which number it has in a mesh. Blocks of 64 x 64 x 64 cells are made when they
// are asked for, and kept for a while, so memory does not grow with the grid.
#pragma once
#include <algorithm>
#include <unordered_map>

#include "store/base/in_order.hpp"
#include "tools/export/refined/leaf_block.hpp"
#include "tools/export/refined/refined.hpp"

namespace teracell::exports {

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
  std::shared_ptr<const LeafBlock> block(const Index3& at) const;
  // Takes all cells out of the mesh but those of its largest region: cells that touch through faces. Of equally large ones, the first.
  void keep_largest_region(const std::function<void(double share)>& progress);
  // Gives numbers to the mesh's cells, in Morton order.
  void number(const std::function<void(double share)>& progress);
  int64_t cells() const { return cells_; }
  // Makes something of each block in which leaves begin, on all threads, and takes it in Morton order.
  template <class Make, class Take>
  void for_each_block(const std::function<void(double share)>& progress, Make&& make, Take&& take) const;

 private:
  std::shared_ptr<LeafBlock> make(const Index3& at) const;

  const RefinedGrid& refined_;
  const MeshOfLeaves& mesh_;
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
  NearLeaves(const LeafGrid& grid, const Index3& block) : grid_(grid), box_(grid.box()), centre_(block), own_(near_[13] = grid.block(block)) {
    for (size_t d = 0; d < 3; ++d) {
      own_lo_[d] = std::max(block[d] << LeafBlock::kBits, box_.lo[d]);
      const int64_t own_hi = std::min((block[d] + 1) << LeafBlock::kBits, box_.hi[d]);
      own_size_[d] = own_->cover ? 0 : static_cast<uint64_t>(std::max<int64_t>(0, own_hi - own_lo_[d]));
    }
  }

  const LeafBlock& own() const { return *own_; }
  // None outside the box.
  LeafAt at(const Index3& cell) {
    for (size_t d = 0; d < 3; ++d)
      if (static_cast<uint64_t>(cell[d] - own_lo_[d]) >= own_size_[d]) return elsewhere(cell);
    return in(*own_, cell);
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
  LeafAt in(const LeafBlock& block, const Index3& cell) const {
    const uint32_t i = block.find(cell);
    const int level = block.leaves[i].level;
    return {&block, i, level, {cell[0] >> level << level, cell[1] >> level << level, cell[2] >> level << level}, &box_};
  }
  LeafAt elsewhere(const Index3& cell);
  const LeafBlock& block(const Index3& at);

  const LeafGrid& grid_;
  const Box& box_;
  const Index3 centre_;
  std::array<std::shared_ptr<const LeafBlock>, 27> near_;
  const std::shared_ptr<const LeafBlock> own_;  // one of them
  Index3 own_lo_{};  // its cells in the box; none if a leaf from elsewhere covers it
  std::array<uint64_t, 3> own_size_{};
  std::vector<std::shared_ptr<const LeafBlock>> far_;
};

template <class Make, class Take>
void LeafGrid::for_each_block(const std::function<void(double share)>& progress, Make&& make, Take&& take) const {
  Leaves::Walk walk(refined_.leaves(), mesh_.box, LeafBlock::kBits);
  in_order(
      refined_.threads(), [&] { return walk.next(); },
      [&](const Subtree& s, int) {
        Index3 at = s.first();
        for (int64_t& a : at) a >>= LeafBlock::kBits;
        return std::pair(share_of_walk(mesh_.box, s.first()), make(at));
      },
      [&](auto made) {
        progress(made.first);
        take(std::move(made.second));
      },
      4);
}

}  // namespace teracell::exports
