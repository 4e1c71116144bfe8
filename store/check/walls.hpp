// How thick walls are. The thickness at a cell is the length of the shortest of the three runs of the cell's label through it, along the rays
// and across them. A run that ends at a side of the domain does not count.
#pragma once
#include "store/check/field.hpp"

namespace teracell::inline store {

inline constexpr uint32_t kThickest = 8;  // what is thicker is not told apart

// The cells [from, to) of a ray: all have this thickness, 1 to kThickest.
struct ThinRun {
  uint32_t from, to;
  Label label;
  uint32_t cells;
  friend bool operator==(const ThinRun&, const ThinRun&) = default;
};

// Each thread has its own.
class Walls {
 public:
  // The thin runs of a ray, ascending and disjoint; nothing for the background, label 0. REQUIRES: the ray, counted in the field's rays, lies
  // in its column.
  const std::vector<ThinRun>& thin_runs(const Field& field, uint32_t u, uint32_t v);

 private:
  // Rays beside a ray, along one axis: `step` apart, so many of them before and after.
  struct Row {
    ptrdiff_t step;
    uint32_t before, after;
  };
  struct Interval {
    uint32_t from, to;
  };
  bool may_be_thin(const RayBlock& rays, uint32_t ray, const Row& row) const;
  void along_row(const RayBlock& rays, uint32_t ray, const Row& row);
  struct Kept {
    std::vector<Interval> now, next;
  };
  template <class F>
  static void follow(const RayBlock& rays, uint32_t ray, ptrdiff_t step, uint32_t count, Label label, Interval from, Kept& kept, F&& lost);
  void combine();

  std::vector<ThinRun> found_, out_, open_;
  Kept before_, after_;
};

}  // namespace teracell::store
