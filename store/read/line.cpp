#include "store/read/line.hpp"

#include <algorithm>
#include <limits>

#include "store/base/wanted.hpp"
#include "store/read/query.hpp"

namespace teracell::inline store {
namespace {

constexpr size_t kMostHeld = 65536;  // cells of a stretch

// How the line moves along one axis. `at` is its share of the line where it leaves the cell.
class Walk {
 public:
  Walk(const Axis& axis, double a, double b) : axis_(axis), a_(a), way_(b - a) {}

  // The share at which the line meets a plane.
  double share_of(int64_t plane) const { return (axis_.plane(plane) - a_) / way_; }

  // Cuts [t0, t1] to the grid.
  void clip(double& t0, double& t1) const {
    if (way_ == 0) {
      if (a_ < axis_.plane(0) || a_ >= axis_.plane(axis_.cells())) t1 = -1;
      return;
    }
    const double low = share_of(0), high = share_of(axis_.cells());
    t0 = std::max(t0, std::min(low, high));
    t1 = std::min(t1, std::max(low, high));
  }

  void start(double t) {
    cell_ = axis_.cell_at(std::clamp(a_ + t * way_, axis_.plane(0), axis_.plane(axis_.cells())));
    // Rounding may have put the point into a neighbour.
    if (way_ > 0)
      while (cell_ + 1 < axis_.cells() && share_of(cell_ + 1) <= t) ++cell_;
    if (way_ < 0)
      while (cell_ > 0 && share_of(cell_) <= t) --cell_;
    look();
  }
  void step() {
    cell_ += way_ > 0 ? 1 : -1;
    look();
  }
  int64_t cell() const { return cell_; }
  double leaves() const { return leaves_; }

 private:
  void look() { leaves_ = way_ == 0 ? std::numeric_limits<double>::infinity() : share_of(way_ > 0 ? cell_ + 1 : cell_); }

  const Axis& axis_;
  const double a_, way_;
  int64_t cell_ = 0;
  double leaves_ = 0;
};

// A stretch of the line within one ray of the grid, and its cells along the ray, in the order of the line.
struct LineCells {
  std::vector<std::pair<int64_t, double>> cells;  // and the share at which each is left
  double from = 0;
};

class Collector {
 public:
  explicit Collector(const GridReader& reader) : reader_(reader), material_(strongest_material(reader.meta())), w_(reader.meta().frame().w) {}

  // Takes the materials of the cells of a stretch. `cell`: one of them.
  void take(Index3 cell, const LineCells& stretch) {
    Wanted::stop_if_not();
    const int64_t low = std::min(stretch.cells.front().first, stretch.cells.back().first),
                  high = std::max(stretch.cells.front().first, stretch.cells.back().first);
    Box box{cell, cell};
    for (int d = 0; d < 3; ++d) box.hi[d] = box.lo[d] + 1;
    box.lo[w_] = low, box.hi[w_] = high + 1;
    along_.assign(static_cast<size_t>(high - low + 1), 0);
    for_each_run(reader_, 0, box, [&](const BoxRun& run) { std::fill_n(along_.begin() + (run.start[w_] - low), run.length, material_(*run.set)); });
    double from = stretch.from;
    for (const auto& [i, to] : stretch.cells) {
      add(from, to, along_[static_cast<size_t>(i - low)]);
      from = to;
    }
  }
  std::vector<LineRun> runs;

 private:
  void add(double from, double to, uint32_t material) {
    if (!(to > from)) return;
    if (!runs.empty() && runs.back().material == material) {
      runs.back().to = to;
      ++runs.back().cells;
    } else {
      runs.push_back({from, to, material, 1});
    }
  }
  const GridReader& reader_;
  const SetValue material_;
  const int w_;
  std::vector<uint32_t> along_;
};

}  // namespace

std::vector<LineRun> read_line(const GridReader& reader, const Vec3& a, const Vec3& b) {
  const Metadata& meta = reader.meta();
  const int w = meta.frame().w;
  std::array<Walk, 3> walks = {Walk(meta.grid.axis[0], a[0], b[0]), Walk(meta.grid.axis[1], a[1], b[1]), Walk(meta.grid.axis[2], a[2], b[2])};
  double t0 = 0, t1 = 1;
  for (const Walk& walk : walks) walk.clip(t0, t1);
  Collector collector(reader);
  if (!(t1 > t0)) return {};
  for (Walk& walk : walks) walk.start(t0);
  LineCells stretch;
  stretch.from = t0;
  for (double t = t0;;) {
    Walk& next = *std::ranges::min_element(walks, {}, &Walk::leaves);
    t = std::max(t, std::min(next.leaves(), t1));
    stretch.cells.emplace_back(walks[static_cast<size_t>(w)].cell(), t);
    if (&next != &walks[static_cast<size_t>(w)] || t >= t1 || stretch.cells.size() == kMostHeld) {  // the next cell may lie in another ray
      collector.take({walks[0].cell(), walks[1].cell(), walks[2].cell()}, stretch);
      stretch = {{}, t};
    }
    if (t >= t1) return std::move(collector.runs);
    next.step();
  }
}

}  // namespace teracell::store
