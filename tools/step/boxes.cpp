#include "tools/step/boxes.hpp"

#include <BRepBndLib.hxx>
#include <Bnd_Box.hxx>
#include <TopLoc_Location.hxx>
#include <algorithm>
#include <cmath>
#include <gp_Trsf.hxx>
#include <limits>
#include <numeric>

namespace teracell::step {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Box of(Bnd_Box box) {
  Box out;
  box.SetGap(0);
  box.Get(out.lo[0], out.lo[1], out.lo[2], out.hi[0], out.hi[1], out.hi[2]);
  return out;
}

// The box of a box's corners where a matrix puts them.
Box moved(const Box& box, const Matrix& m) {
  Box out;
  for (size_t row = 0; row < 3; ++row) {
    out.lo[row] = out.hi[row] = m[4 * row + 3];
    for (size_t d = 0; d < 3; ++d) {
      const double a = m[4 * row + d] * box.lo[d], b = m[4 * row + d] * box.hi[d];
      out.lo[row] += std::min(a, b), out.hi[row] += std::max(a, b);
    }
  }
  return out;
}

void extend(Box& box, const Box& by) {
  for (size_t d = 0; d < 3; ++d) box.lo[d] = std::min(box.lo[d], by.lo[d]), box.hi[d] = std::max(box.hi[d], by.hi[d]);
}

// The columns of the linear part, divided by their common length. False where the matrix is no rotation times a scale: then the box of
// what it moves is that of the moved corners.
bool split(const Matrix& m, std::array<double, 9>& rotation, double& scale) {
  scale = std::sqrt(m[0] * m[0] + m[4] * m[4] + m[8] * m[8]);
  if (!(scale > 0)) return false;
  for (size_t row = 0; row < 3; ++row)
    for (size_t d = 0; d < 3; ++d) rotation[3 * row + d] = m[4 * row + d] / scale;
  const auto& r = rotation;
  for (size_t a = 0; a < 3; ++a)
    for (size_t b = 0; b < 3; ++b)
      if (std::abs(r[a] * r[b] + r[3 + a] * r[3 + b] + r[6 + a] * r[6 + b] - (a == b ? 1 : 0)) > 1e-9) return false;
  return r[0] * (r[4] * r[8] - r[5] * r[7]) - r[1] * (r[3] * r[8] - r[5] * r[6]) + r[2] * (r[3] * r[7] - r[4] * r[6]) > 0;
}

// Whether each axis becomes an axis.
bool keeps_axes(const Matrix& m) {
  for (size_t row = 0; row < 3; ++row)
    if ((m[4 * row] != 0) + (m[4 * row + 1] != 0) + (m[4 * row + 2] != 0) > 1) return false;
  return true;
}

constexpr std::array<double, 9> kUnturned = {1, 0, 0, 0, 1, 0, 0, 0, 1};

}  // namespace

const Box& Boxes::loose(uint32_t shape) {
  const auto [known, fresh] = loose_.try_emplace(shape);
  if (!fresh) return known->second;
  Bnd_Box box;
  BRepBndLib::Add(model_.shapes[shape].shape, box, false);
  return known->second = of(box);
}

Box Boxes::tight(const Instance& instance) {
  std::array<double, 9> r;
  double scale = 1;
  const bool turned = !keeps_axes(instance.matrix) && split(instance.matrix, r, scale);
  if (!turned) r = kUnturned;
  const auto [known, fresh] = tight_.try_emplace({instance.shape, r});
  if (fresh) {
    TopoDS_Shape shape = model_.shapes[instance.shape].shape;
    if (turned) {
      gp_Trsf turn;
      turn.SetValues(r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0);
      turn.SetScaleFactor(1);  // within the kernel's tolerance it is 1 already
      shape = shape.Moved(TopLoc_Location(turn));
    }
    Bnd_Box box;
    BRepBndLib::AddOptimal(shape, box, false, false);
    known->second = of(box);
  }
  if (!turned) return moved(known->second, instance.matrix);
  const Matrix& m = instance.matrix;
  return moved(known->second, {scale, 0, 0, m[3], 0, scale, 0, m[7], 0, 0, scale, m[11]});
}

// Tight boxes cost much, so on each side only those instances get one whose loose box reaches further than what is known.
Box Boxes::around(const std::vector<Instance>& instances) {
  std::vector<Box> boxes;
  boxes.reserve(instances.size());
  for (const Instance& i : instances) boxes.push_back(moved(loose(i.shape), i.matrix));
  Box out = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  std::vector<bool> done(instances.size());
  std::vector<size_t> order(instances.size());
  for (size_t side = 0; side < 6; ++side) {
    const size_t d = side % 3;
    const auto reach = [&](const Box& b) { return side < 3 ? -b.lo[d] : b.hi[d]; };
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::stable_sort(order, [&](size_t a, size_t b) { return reach(boxes[a]) > reach(boxes[b]); });
    for (const size_t i : order) {
      if (reach(boxes[i]) <= reach(out)) break;
      if (!done[i]) extend(out, tight(instances[i]));
      done[i] = true;
    }
  }
  return out;
}

}  // namespace teracell::step
