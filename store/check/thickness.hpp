// How thick walls are: the local thickness (T. Hildebrand, P. Rüegsegger, 1997), with slack for the steps of a grid.
//
// Balls have their centres at the cell centres and the cell corners within a body. The depth of a centre is its distance, in cells, to the centre
// of the nearest cell outside the body, less 0.5; beyond the domain's sides nothing is. A cell is thin below W when no centre of a depth of at
// least W / 2 lies within 0.75 W + 1.5 of its centre. Its thickness is the largest W of 1, 1.5, 2 .. 8 below which it isn't thin.
//
// Most cells of a body are proven to be thick by runs alone: on rays near them those cells are found that are 4.5 cells deep (a run, less what the
// rays around it take away), and what lies within 7.5 cells of them is 8 cells thick. Every third ray is tried first. Only the rest is looked at cell
// by cell. All distances are compared by their squares, in whole numbers.
#pragma once
#include "store/check/field.hpp"

namespace teracell::inline store {

inline constexpr uint32_t kThickest = 16;  // half cells: what is thicker is not told apart

// The cells [from, to) of the ray (u, v), counted in the field: all have this thickness, in half cells, 2 to kThickest - 1.
struct ThinRun {
  uint32_t u, v, from, to;
  Label label;
  uint32_t halves;
  friend bool operator==(const ThinRun&, const ThinRun&) = default;
};

// Each thread has its own.
class Thickness {
 public:
  struct Interval {
    uint32_t from, to;
  };
  // `walls[label]`: whether cells of this label have a thickness.
  explicit Thickness(std::vector<bool> walls) : walls_(std::move(walls)) {}

  // The runs of cells of the field's column that are less than 8 cells thick, by v, u and from; neighbours differ.
  const std::vector<ThinRun>& thin_runs(const Field& field);

 private:
  struct Core {  // of a ray: cells that are deep
    uint32_t from, to;
    Label label;
  };
  struct Stretch {  // cells of a ray that may be thin
    uint32_t u, v, from, to;
    Label label;
  };
  std::span<const Core> cores_of(const RayBlock& rays, uint32_t u, uint32_t v);
  void add_core(const RayBlock& rays, uint32_t u, uint32_t v, uint32_t run, Interval cells, Label label);
  void find_doubtful(const Field& field);
  void take_proven(std::span<const Core> cores, Label label, uint32_t reach);
  void look_at(const RayBlock& rays, std::span<Stretch> tile);
  void find_changes(const RayBlock& rays, std::span<const Stretch> tile);
  void measure(const RayBlock& rays, std::span<const Stretch> block, Interval cells, Interval valid);

  const std::vector<bool> walls_;
  std::vector<Interval> cores_of_;  // of each ray: where its cores are among these; kUnknown until they were looked for
  std::vector<Core> cores_;
  std::vector<Interval> left_, next_;
  std::vector<Stretch> doubtful_, block_;
  std::vector<uint32_t> changes_;
  std::vector<uint8_t> one_, turned_, other_;  // squared distances in a block of cells
  std::vector<uint8_t> centres_;  // the thickness that its cells, and then its corners, allow
  std::vector<ThinRun> out_;
};

}  // namespace teracell::store
