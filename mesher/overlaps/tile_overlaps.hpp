// Counts the overlaps of a tile while its rays are composed. Where a ray leaves a body, its stretches in common with all bodies that it
// stays inside of end. So a pair costs a ray a step or two, however many other bodies begin and end meanwhile. (Rejected: to count the pairs
// of every run. A ray through 1000 nested bodies has 500,000 pairs, but 300 million pairs of runs.)
//
// With the bodies that the ray was inside of before it entered the body that it leaves now, the stretch in common is the same one, and they
// are mostly those of the ray before. They are counted as a group, so nested bodies cost little more than comparing their numbers.
//
// Rays that take the same course (compose.hpp) are counted together.
#pragma once
#include <algorithm>
#include <span>

#include "mesher/overlaps/overlap.hpp"

namespace teracell::mesher {

// A body that a ray is inside of, from cell `from` on.
struct Inside {
  uint32_t rank, body, from;
  uint32_t crossing = 0;  // the first one of that cell; for who composes rays
};

// Which body owns the cells of a ray from `since` on.
struct Owner {
  uint32_t rank, since;
};

// Not thread-safe.
class TileOverlaps {
 public:
  // Of rays.
  struct Stretches {
    uint64_t cells = 0;
    uint64_t first = ~uint64_t{0};    // the least key of a cell (shift_)
    uint32_t from = ~uint32_t{0}, to = 0;         // the box along the rays
    uint8_t u0 = 255, u1 = 0, v0 = 255, v1 = 0;   // the box of the rays, the last ones included
    void add(const Stretches& other);
  };
  // `bodies`: how many there are.
  TileOverlaps(size_t bodies, int ray_axis);
  void begin_tile(uint32_t nu) { nu_ = nu; }
  // The cells [from, to) of ray v * nu + u.
  Stretches stretch(uint32_t ray, uint32_t from, uint32_t to) const;
  // A ray leaves `body` at cell `to` and stays inside the `others`, of which the one of the lowest rank stands last. `owner` is that of cell
  // `to` - 1. Rays that do the same may be taken together: then numbers that have the same order on each of them, such as those of their crossings,
  // stand for cells. stretches(from): what lies between `from` and `to`.
  template <class F>
  void leave(const Inside& body, uint32_t to, std::span<const Inside> others, const Owner& owner, F&& stretches);
  // What was found since the last call, packed; empty if there is nothing. `cells` are those of the tile.
  Bytes take(const Box& cells);

 private:
  static constexpr uint32_t kNobody = ~uint32_t{0};
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
  // The rank of the body that owns the whole stretch which begins at `from` and ends where `owner` is the owner.
  static uint32_t sole_owner(const Owner& owner, uint32_t from) { return owner.since <= from ? owner.rank : kNobody; }
  static Common& common(std::vector<Common>& list, size_t& next, const Inside& other);
  static void list_group(uint32_t rank, Left& left);
  Overlap overlap(uint32_t body, const Common& common, const Box& cells) const;

  const RayFrame frame_;
  std::array<int, 3> shift_;  // where the number of a cell along x, y, z stands in a key; keys sort by z, then y, then x
  std::vector<Left> left_;  // by body
  std::vector<Inside> met_;  // bodies in left_ that have something in common with others
  uint32_t nu_ = 1;
};

inline void TileOverlaps::Stretches::add(const Stretches& other) {
  cells += other.cells;
  first = std::min(first, other.first);
  from = std::min(from, other.from), to = std::max(to, other.to);
  u0 = std::min(u0, other.u0), u1 = std::max(u1, other.u1);
  v0 = std::min(v0, other.v0), v1 = std::max(v1, other.v1);
}

inline TileOverlaps::Stretches TileOverlaps::stretch(uint32_t ray, uint32_t from, uint32_t to) const {
  const uint32_t u = ray % nu_, v = ray / nu_;
  const uint64_t key = uint64_t{from} << shift_[frame_.w] | uint64_t{u} << shift_[frame_.u] | uint64_t{v} << shift_[frame_.v];
  const auto u8 = static_cast<uint8_t>(u), v8 = static_cast<uint8_t>(v);
  return {to - from, key, from, to, u8, u8, v8, v8};
}

template <class F>
void TileOverlaps::leave(const Inside& body, uint32_t to, std::span<const Inside> others, const Owner& owner, F&& stretches) {
  if (body.from >= to) return;
  Left& left = left_[body.body];
  const bool is_new = left.list.empty() && left.group.empty();
  size_t next = 0, before = 0;
  bool same = true;
  for (const Inside& other : others) {
    if (other.from <= body.from) {
      same = same && before < left.group.size() && left.group[before].rank == other.rank;
      ++before;
    } else if (other.from < to) {
      Common& c = common(left.list, next, other);
      c.stretches.add(stretches(other.from));
      c.third |= sole_owner(owner, other.from) != std::min(body.rank, other.rank);
    }
  }
  if (before > 0) {
    const uint32_t sole = sole_owner(owner, body.from);
    if (!same || before != left.group.size()) {
      list_group(body.rank, left);
      std::ranges::copy_if(others, std::back_inserter(left.group), [&](const Inside& other) { return other.from <= body.from; });
      left.owner = sole;
    }
    left.of_group.add(stretches(body.from));
    if (left.owner != sole) left.owner = kNobody;
  }
  if (is_new && !(left.list.empty() && left.group.empty())) met_.push_back(body);
}

}  // namespace teracell::mesher
