// The leaves of a refined grid, as a stream in Morton order: what all outputs stand on.
//
// A leaf of level L is the part of a cell of level L that lies in the grid. Leaves that touch differ by at most one level, also over edges and
// corners, and where all interfaces want level 0 a leaf has one label.
#pragma once
#include <map>

#include "store/refine/splits.hpp"

namespace teracell::inline store {

struct Leaf {
  Index3 cell;  // of its level
  int level;
  Label label;  // of the level-0 cell at its first one + floor(2^(level - 1)) on each axis, or the grid's last
  Index3 first() const { return {cell[0] << level, cell[1] << level, cell[2] << level}; }  // of its level-0 cells
  friend bool operator==(const Leaf&, const Leaf&) = default;
};

// A cell of a level above 0: with its leaves, or a leaf itself.
struct Subtree {
  int level;
  Index3 cell;
  Index3 first() const { return {cell[0] << level, cell[1] << level, cell[2] << level}; }
};
// A leaf of a subtree. A code of at most 24 bits is the Morton code of the leaf's first level-0 cell, counted from that of the subtree.
struct LeafInSubtree {
  uint32_t code : 24, level : 8;
  Label label;
};
// The first level-0 cell, from that of the subtree on.
Index3 cell_of_code(uint32_t code);

// Of blocks, by their place.
struct PlaceHash {
  size_t operator()(const Index3& at) const {
    return ChunkKeyHash{}({0, static_cast<uint32_t>(at[0]), static_cast<uint32_t>(at[1]), static_cast<uint32_t>(at[2])});
  }
};

// How far a walk in Morton order over a box has come where it is at this cell, from 0 to 1: it never falls.
double share_of_walk(const Box& box, const Index3& first);

// Leaves by level and label.
using LeafCounts = std::map<std::pair<int, Label>, uint64_t>;

class Leaves {
 public:
  // Keeps a reference to the reader. A file without a name is made in `folder`; `memory`: bytes, for what is kept for a while. Throws UsageError,
  // IoError.
  Leaves(const GridReader& reader, const Refinement& refinement, const std::filesystem::path& folder, size_t memory = kMemory);
  static constexpr size_t kMemory = size_t{120} << 20;

  const GridReader& reader() const { return reader_; }
  int coarsest() const { return splits_.coarsest(); }
  // To be called before the others, with a box of level-0 cells that holds theirs.
  void prepare(const Box& box, int threads, const std::function<void(double share)>& progress);
  bool is_prepared(const Box& box) const;
  // Calls take() with the leaves that have a cell in the box, in the order of the Morton codes of their first level-0 cells (bits of x, y, z in turn,
  // x lowest): some thousands at a time, on the calling thread. What they are does not depend on the threads. REQUIRES: prepared.
  void for_each(const Box& box, int threads, const std::function<void(double share)>& progress,
                const std::function<void(std::span<const Leaf>)>& take) const;
  LeafCounts count(const Box& box, int threads, const std::function<void(double share)>& progress) const;

  // What for_each() goes through, for those who go through it otherwise. The subtrees that meet a box, in Morton order: those of a level, and
  // larger leaves. REQUIRES: the level is above 2.
  class Walk {
   public:
    Walk(const Leaves& leaves, const Box& box, int level);
    std::optional<Subtree> next();

   private:
    bool meets(const Subtree& s) const;
    const Leaves& leaves_;
    const Box box_;
    const int level_;
    std::vector<Subtree> waiting_;
  };
  // Whether a cell is no leaf and no part of one. REQUIRES: the level is above 2, and at most the coarsest.
  bool is_split(int level, const Index3& cell) const;
  // The leaf that holds a subtree's cell and more, if there is one. REQUIRES: the level is above 2.
  std::optional<Subtree> larger_leaf(const Subtree& s) const;
  // The leaves of such a subtree that have a cell in the box, in Morton order. Subtrees beside each other are made together, and kept for a while.
  // REQUIRES: it is a leaf, or its level is at most 7.
  std::vector<LeafInSubtree> leaves_of(const Subtree& s, const Box& box) const;

 private:
  template <class Sink>
  class Block;
  Box by_rays(const Box& box) const;
  // `again`: whether others of the same block will be asked for.
  template <class Sink>
  void visit(const Subtree& s, const Box& box, bool again, Sink&& sink) const;

  const GridReader& reader_;
  const RayFrame frame_;
  Splits splits_;
};

}  // namespace teracell::store
