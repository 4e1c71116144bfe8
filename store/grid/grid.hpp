// Cells and coordinates: an Axis is a row of cells, a Grid is three of them.
//
// Every double here is specified to the last bit (mesher/SCENES.md, "What a cell is"): operations round one by one, and none are
// fused. Centres and planes are computed when they are asked for, so a uniform axis takes the same memory for 10 cells and
// for 10^9.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace teracell::inline store {

using Vec3 = std::array<double, 3>;
// The same on every machine, unlike std::hypot: libraries round that differently.
inline double norm(const Vec3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }
using Index3 = std::array<int64_t, 3>;

// A half-open box of cells, [lo, hi) on x, y, z.
struct Box {
  Index3 lo{0, 0, 0};
  Index3 hi{0, 0, 0};
  bool empty() const { return lo[0] >= hi[0] || lo[1] >= hi[1] || lo[2] >= hi[2]; }
  std::array<int64_t, 6> corners() const { return {lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]}; }  // as JSON has them
  friend bool operator==(const Box&, const Box&) = default;
};

// Whether a cell lies in both.
inline bool overlap(const Box& a, const Box& b) {
  for (size_t d = 0; d < 3; ++d)
    if (a.lo[d] >= b.hi[d] || b.lo[d] >= a.hi[d]) return false;
  return true;
}

// A row of cells, each with a sample point, its "centre". Immutable; threads may share it.
class Axis {
 public:
  // Positions along a ray have 32 bits: the format is limited to two billion cells per axis.
  static constexpr int64_t kMaxCells = (int64_t{1} << 31) - 2;

  Axis() = default;
  // centre(i) = min + ((first + i) + sample) * step, plane(i) = min + (first + i) * step.
  // Throws UsageError unless step > 0, 0 <= sample < 1, 1 <= cells <= kMaxCells and the centres ascend strictly.
  static Axis uniform(double min, double step, int64_t first, int64_t cells, double sample);
  // centre(i) = p[i] + sample * (p[i + 1] - p[i]). Throws UsageError like uniform().
  static Axis graded(std::vector<double> planes, double sample);

  bool is_graded() const { return !planes_.empty(); }
  int64_t cells() const { return cells_; }
  double sample() const { return sample_; }
  double min() const { return plane(0); }
  double max() const { return plane(cells_); }
  double origin() const { return min_; }      // uniform: the stored min, the lower plane of cell -first
  double step() const { return step_; }       // uniform
  int64_t first() const { return first_; }    // uniform
  const std::vector<double>& planes() const { return planes_; }  // graded

  double centre(int64_t i) const {
    return is_graded() ? planes_[i] + sample_ * (planes_[i + 1] - planes_[i]) : min_ + (static_cast<double>(first_ + i) + sample_) * step_;
  }
  double plane(int64_t i) const { return is_graded() ? planes_[i] : min_ + static_cast<double>(first_ + i) * step_; }

  double shortest_cell() const;  // the least distance between neighbouring planes
  double longest_cell() const;   // the largest

  // The number of centres below x: the first cell whose centre is at or above x, in [0, cells()].
  int64_t first_centre_from(double x) const;
  // The cell that x lies in. A plane belongs to the cell above it, max() to the last cell. REQUIRES: min() <= x <= max().
  int64_t cell_at(double x) const;

  friend bool operator==(const Axis&, const Axis&) = default;

 private:
  void check() const;
  double min_ = 0, step_ = 1, sample_ = 0.5;
  int64_t first_ = 0, cells_ = 1;
  std::vector<double> planes_;
};

// Three axes. Level L of the pyramid has ceil(cells / 2^L) cells along each.
struct Grid {
  std::array<Axis, 3> axis;

  Index3 cells() const { return {axis[0].cells(), axis[1].cells(), axis[2].cells()}; }
  Index3 cells(int level) const;
  Box box(int level) const { return {{0, 0, 0}, cells(level)}; }
  int levels() const;  // the last one has a single cell
  void check_level(int level) const;  // throws UsageError, with the levels that there are, when this is none of them
  friend bool operator==(const Grid&, const Grid&) = default;
};

inline int64_t ceil_shift(int64_t n, int bits) { return (n + (int64_t{1} << bits) - 1) >> bits; }

// The axes of a picture across `axis`: z -> (x, y), y -> (x, z), x -> (y, z). Rays along `axis` are numbered (u, v) too.
struct RayFrame {
  int u, v, w;
  static constexpr RayFrame along(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2, axis}; }
  // What is given by u, v, w, by x, y, z.
  constexpr Index3 cell(int64_t at_u, int64_t at_v, int64_t at_w) const {
    Index3 out{};
    out[u] = at_u, out[v] = at_v, out[w] = at_w;
    return out;
  }
  constexpr Box box(const Index3& lo, const Index3& hi) const { return {cell(lo[0], lo[1], lo[2]), cell(hi[0], hi[1], hi[2])}; }
};

// "x", "y" or "z".
inline std::string axis_name(int axis) { return std::string(1, "xyz"[axis]); }
inline std::optional<int> axis_named(std::string_view name) {
  return name == "x" ? std::optional(0) : name == "y" ? std::optional(1) : name == "z" ? std::optional(2) : std::nullopt;
}

// The product of three counts as text: it may exceed 64 bits.
std::string cell_count_text(const Index3& cells);

}  // namespace teracell::store
