// The points of a mesh of leaves, and their numbers in each of its parts.
//
// A point belongs to the leaf that holds the cell above it (on the upper sides of the box, to the last leaf before it). A leaf has up to 27: its
// lower corner, what finer neighbours have on its lower faces, and on the upper sides of the box the rest. So a number is that of the leaf's
// first point, and the bits that are set below the point's own.
#pragma once
#include "tools/export/refined/leaf_grid.hpp"

namespace teracell::exports {

// A part has the cells with consecutive numbers.
using PartBegins = std::vector<int64_t>;  // the first cell of each part, and the end
uint32_t part_of(const PartBegins& begins, int64_t cell);

struct PointBlock {
  // What a part has of a leaf: a bit for each of the leaf's 27 places that it has a point at, and the number of the first of them among the
  // block's.
  struct Entry {
    uint32_t points = 0, first = 0;
  };
  uint32_t part = 0;           // the part that most leaves have points of
  std::vector<Entry> entries;  // its own, by leaf
  struct Other {
    uint32_t leaf, part;
    Entry entry;
  };
  std::vector<Other> others;   // of other parts, by leaf, then by part
  std::vector<std::pair<uint32_t, int64_t>> parts;  // that have points here: how many, and once all are numbered, the first number
  const Entry* find(uint32_t leaf, uint32_t part) const;
  int64_t first(uint32_t part) const;
  size_t memory() const {
    return sizeof *this + entries.capacity() * sizeof entries[0] + others.capacity() * sizeof others[0] + parts.capacity() * sizeof parts[0];
  }
};

class LeafPoints {
 public:
  // Keeps references to both.
  LeafPoints(const LeafGrid& grid, const PartBegins& begins);

  // Counts the points, and gives them numbers. Afterwards block() tells them.
  void number(const std::function<void(double share)>& progress);
  int64_t points(uint32_t part) const { return points_[part]; }
  std::shared_ptr<const PointBlock> block(const Index3& at) const;

  // The places of a leaf's points, by number: x + 3 y + 9 z, where 0 is its lower side on an axis, 1 halfway, 2 its upper one.
  static Index3 place(const LeafAt& leaf, uint32_t number);

 private:
  PointBlock make(const Index3& at) const;

  const LeafGrid& grid_;
  const PartBegins& begins_;
  std::vector<int64_t> points_;  // by part
  std::unordered_map<Index3, std::vector<std::pair<uint32_t, int64_t>>, PlaceHash> first_;
  mutable LruCache<Index3, PointBlock, PlaceHash> blocks_;
};

// Looks points up around a block. Not thread-safe.
class NearPoints {
 public:
  NearPoints(const LeafPoints& points, NearLeaves& leaves) : points_(points), leaves_(leaves) {}
  // Its number in a part; negative if that has no point there.
  int64_t number(const Index3& point, uint32_t part, const Box& box);

 private:
  const LeafPoints& points_;
  NearLeaves& leaves_;
  std::unordered_map<const LeafBlock*, std::shared_ptr<const PointBlock>> blocks_;  // the leaves' keeper has them as long
  const LeafBlock* last_ = nullptr;
  const PointBlock* of_last_ = nullptr;
};

}  // namespace teracell::exports
