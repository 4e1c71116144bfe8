// Finds where facets cross lines through sample points, along any axis. The answers are the exact ones of rows.hpp and
// height.hpp, so along the axis of the rays the crossings are those of the engines.
#pragma once
#include <optional>

#include "mesher/engines/height.hpp"
#include "mesher/engines/rows.hpp"
#include "mesher/tiles/rays.hpp"

namespace teracell::mesher {

// Not thread-safe.
class FacetLines {
 public:
  // A crossing lies below a sample point of `points`: the grid's own axis, or its planes (plane_axis). Keeps references to both.
  FacetLines(const Grid& grid, int axis, const Axis& points)
      : frame_(RayFrame::along(axis)), grid_(grid), points_(points), find_u_(grid.axis[frame_.u]), find_v_(grid.axis[frame_.v]) {}

  // Calls f(cell, above, up) for the lines through `cells` (of any extent along the axis) that cross the facet, in rows: the line
  // of `cell` and those after it along frame().u. `above` has the number of the first sample point above the facet for each of
  // them; `up` as in rows.hpp. Adds to `exact` as FacetHeight does.
  template <class F>
  void cross(const Facet& facet, const Box& cells, uint64_t& exact, F&& f) {
    cross_rows(facet, cells, exact, [&](const Index3& cell, std::span<const uint32_t> above, bool up, auto&&...) { f(cell, above, up); });
  }
  // Calls f(cell, above, subs, up): as cross(), with where the facet lies below these sample points (FacetHeight::first_sub_positions).
  // REQUIRES: `points` is the grid's own axis.
  template <class F>
  void cross_exactly(const Facet& facet, const Box& cells, uint64_t& exact, F&& f) {
    const auto with_subs = [&](const Index3& cell, std::span<const uint32_t> above, bool up, const FacetHeight& height, std::span<const double> u,
                               double v) {
      height.first_sub_positions(u, v, above.data(), subs_.data(), exact);
      f(cell, above, std::span<const uint32_t>(subs_.data(), above.size()), up);
    };
    cross_rows(facet, cells, exact, with_subs);
  }
  const RayFrame& frame() const { return frame_; }

 private:
  // Lines are handled in blocks, because a facet may be as long as the grid.
  static constexpr int64_t kBlock = 4096;
  template <class F>
  void cross_rows(const Facet& facet, const Box& cells, uint64_t& exact, F&& f) {
    const auto [u0, u1] = range(facet, frame_.u, find_u_, cells);
    const auto [v0, v1] = range(facet, frame_.v, find_v_, cells);
    if (u0 >= u1) return;
    std::optional<FacetHeight> height;
    Index3 cell = cells.lo;
    for (int64_t first_v = v0; first_v < v1; first_v += kBlock) {
      fill(v_, grid_.axis[frame_.v], first_v, v1);
      const FacetRows rows(facet, frame_, RayFinder(v_));
      if (rows.begin() == rows.end()) continue;
      for (int64_t first_u = u0; first_u < u1; first_u += kBlock) {
        fill(u_, grid_.axis[frame_.u], first_u, u1);
        const RayFinder lines(u_);
        for (uint32_t row = rows.begin(); row < rows.end(); ++row) {
          const FacetRows::Rays met = rows.at(row, v_[row], lines, exact);
          if (met.from == met.to) continue;
          if (!height) height.emplace(facet, frame_, points_);
          const std::span<const double> u(u_.data() + met.from, met.to - met.from);
          height->first_cells(u, v_[row], above_.data(), exact);
          cell[frame_.u] = first_u + met.from;
          cell[frame_.v] = first_v + row;
          f(cell, std::span<const uint32_t>(above_.data(), u.size()), met.up, *height, u, v_[row]);
        }
      }
    }
  }
  static void fill(std::vector<double>& out, const Axis& axis, int64_t from, int64_t to) {
    out.clear();
    for (int64_t i = from; i < std::min(to, from + kBlock); ++i) out.push_back(axis.centre(i));
  }
  static std::pair<int64_t, int64_t> range(const Facet& facet, int d, const RayBounds& rays, const Box& cells) {
    const auto& [a, b, c] = facet.vertex;
    return {std::max<int64_t>(cells.lo[d], rays.first(std::min(std::min(a[d], b[d]), c[d]))),
            std::min<int64_t>(cells.hi[d], rays.last(std::max(std::max(a[d], b[d]), c[d])))};
  }

  const RayFrame frame_;
  const Grid& grid_;
  const Axis& points_;
  const RayBounds find_u_, find_v_;
  std::vector<double> u_, v_;
  std::vector<uint32_t> above_ = std::vector<uint32_t>(kBlock), subs_ = std::vector<uint32_t>(kBlock);
};

// An axis whose sample points are exactly the planes of another axis.
inline Axis plane_axis(const Axis& axis) {
  if (!axis.is_graded()) return Axis::uniform(axis.origin(), axis.step(), axis.first(), axis.cells() + 1, 0);
  std::vector<double> planes = axis.planes();
  const size_t last = planes.size() - 1;
  planes.push_back(planes[last] +
                   (planes[last] - planes[last - 1]));  // needed only as the last cell's upper plane: sample points lie on lower planes
  return Axis::graded(std::move(planes), 0);
}

}  // namespace teracell::mesher
