// The first visible cell on a line of sight.
//
// The line goes down the pyramid: of a coarse cell whose set has something visible it passes the finer cells in their order, and skips a coarse
// cell without anything visible as a whole. So what it finds is what it would find cell by cell, at the cost of some dozens of cells.
//
// A line is in a cell where T(lower plane) <= t < T(upper plane) on each axis, with T(p) = (p - from) / along for planes p. T is monotone in
// doubles too, so it makes no difference at which level the line was before.
#pragma once
#include <optional>

#include "server/render/camera.hpp"
#include "server/render/cells/differing.hpp"
#include "server/render/cut.hpp"
#include "server/render/occupancy.hpp"

namespace teracell::server {

struct Hit {
  double t;
  Label label;  // or Visible::damage()
  int face;     // the axis of the plane by which the line enters the cell; 3 + i: plane i of the cuts; -1: the line begins in the cell
  Index3 cell;  // of level `level`
  int level;
};

// What is drawn of a grid, or of what differs from another one; `visible` is then of what differs.
struct Subject {
  Viewed viewed;
  const Visible& visible;
  const Occupancy& occupancy;
  const Cuts& cuts;
  std::optional<int> level;  // its cells are drawn; without it, those that take at most a quarter of a pixel
};

// Each thread has its own.
class FirstHits {
 public:
  // Keeps references.
  FirstHits(const Subject& subject, const Camera& camera);
  std::optional<Hit> first(const Sight& sight);

 private:
  // What is left of a line of sight between two cuts.
  struct Stretch {
    double begin, end;
    int face;  // of `begin`
  };
  struct Line {
    Sight sight;
    Vec3 inverse;
    double begin;  // of the stretch
    int face;
  };
  double time(int axis, int64_t plane) const;  // of a plane of level 0
  void clip();
  void remove(const Cut& cut, int plane);
  bool descend(size_t rung, const Index3& cell, double t0, double t1);
  bool pass(size_t rung, const Index3& cell, double t0, double t1);
  bool take(size_t rung, const Index3& cell, double t0, double t1);
  uint32_t seen(size_t rung, const Index3& cell);
  bool occupied(size_t rung, const Index3& cell);
  bool is_drawn(size_t rung, double t) const;
  Label strongest(size_t rung, const Index3& cell);
  int face_of(size_t rung, const Index3& cell, double t0) const;

  const Subject& subject_;
  const Camera& camera_;
  const Grid& grid_;
  const Index3 cells_;
  const RayFrame frame_;
  std::vector<LevelShape> rungs_;  // from one cell down to level 0
  std::vector<double> widest_;     // cell of a rung, along any axis
  NumberedCells<const Visible> shown_;
  std::unique_ptr<Differing> differing_;  // null: what the grid shows
  Line line_;
  std::vector<Stretch> stretches_, shorter_;
  size_t drawn_ = 0;         // the rung of subject_.level
  bool to_the_end_ = false;  // down to level 0, whatever is drawn
  std::optional<Hit> hit_;
};

}  // namespace teracell::server
