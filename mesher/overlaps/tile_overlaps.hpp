// Counts the overlaps of a tile while its rays are composed. Where a ray leaves a body, its stretches in common with all bodies that it
// stays inside of end. So a pair costs a ray a step or two, however many other bodies begin and end meanwhile. (Rejected: to count the pairs
// of every run. A ray through 1000 nested bodies has 500,000 pairs, but 300 million pairs of runs.)
//
// With the bodies that the ray was inside of before it entered the body that it leaves now, the stretch in common is the same one, and they
// are mostly those of the ray before. They are counted as a group, so nested bodies cost little more than comparing their numbers.
#pragma once
#include <span>

#include "mesher/overlaps/overlap.hpp"

namespace teracell::mesher {

// A body that a ray is inside of, from cell `from` on.
struct Inside {
  uint32_t rank, body, from;
};

// Which body owns the cells of a ray from `since` on.
struct Owner {
  uint32_t rank, since;
};

// Not thread-safe.
class TileOverlaps {
 public:
  // `bodies`: how many there are.
  TileOverlaps(size_t bodies, int ray_axis);
  void begin_tile(uint32_t nu) { nu_ = nu; }
  // Ray v * nu + u leaves `body` at cell `to` and stays inside the `others`, of which the one of the lowest rank stands last. `owner` is
  // that of cell `to` - 1.
  void leave(uint32_t ray, const Inside& body, uint32_t to, std::span<const Inside> others, const Owner& owner);
  // What was found since the last call, packed; empty if there is nothing. `cells` are those of the tile.
  Bytes take(const Box& cells);

 private:
  struct Stretches {
    uint64_t cells = 0;
    uint64_t first = ~uint64_t{0};    // the least key of a cell (shift_)
    uint32_t from = ~uint32_t{0}, to = 0;         // the box along the rays
    uint8_t u0 = 255, u1 = 0, v0 = 255, v1 = 0;   // the box of the rays, the last ones included
    void add(const Stretches& other);
  };
  // What the body that is left has in common with another one.
  struct Common {
    uint32_t rank, body;  // of the other one
    bool third;
    Stretches stretches;
  };
  struct Left {
    std::vector<Common> list;  // descending by rank
    // Not in the list yet: stretches that the body has in common with each of these.
    std::vector<Inside> group;  // descending by rank
    Stretches of_group;
    uint32_t owner = 0;  // the rank of the body that owns all of them, if it is one
  };
  Stretches stretch(uint32_t u, uint32_t v, uint32_t from, uint32_t to) const;
  static Common& common(std::vector<Common>& list, size_t& next, const Inside& other);
  static void list_group(uint32_t rank, Left& left);
  Overlap overlap(uint32_t body, const Common& common, const Box& cells) const;

  const RayFrame frame_;
  std::array<int, 3> shift_;  // where the number of a cell along x, y, z stands in a key; keys sort by z, then y, then x
  std::vector<Left> left_;        // by body
  std::vector<Inside> met_;       // bodies in left_ that have something in common with others
  uint32_t nu_ = 1;
};

}  // namespace teracell::mesher
