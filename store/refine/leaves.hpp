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

// Leaves by level and label.
using LeafCounts = std::map<std::pair<int, Label>, uint64_t>;

class Leaves {
 public:
  // Keeps a reference to the reader. A file without a name is made in `folder`. Throws UsageError, IoError.
  Leaves(const GridReader& reader, const Refinement& refinement, const std::filesystem::path& folder);

  const GridReader& reader() const { return reader_; }
  int coarsest() const { return splits_.coarsest(); }
  // To be called before the others, with a box of level-0 cells that holds theirs.
  void prepare(const Box& box, int threads, const std::function<void(double share)>& progress);
  // Calls take() with the leaves that have a cell in the box, in the order of the Morton codes of their first level-0 cells (bits of x, y, z in turn,
  // x lowest): some thousands at a time, on the calling thread. What they are does not depend on the threads. REQUIRES: prepared.
  void for_each(const Box& box, int threads, const std::function<void(double share)>& progress,
                const std::function<void(std::span<const Leaf>)>& take) const;
  LeafCounts count(const Box& box, int threads, const std::function<void(double share)>& progress) const;

 private:
  struct Job;
  class Jobs;
  template <class Sink>
  class Block;
  bool is_split(int level, const Index3& cell) const;  // of a level above that of a block of tier 0
  template <class Sink>
  void visit(const Job& job, const Box& box, Sink&& sink) const;

  const GridReader& reader_;
  const RayFrame frame_;
  Splits splits_;
};

}  // namespace teracell::store
