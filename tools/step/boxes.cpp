#include "tools/step/boxes.hpp"

#include <algorithm>
#include <Bnd_Box.hxx>
#include <BRepBndLib.hxx>
#include <cmath>
#include <gp_Trsf.hxx>
#include <limits>
#include <numeric>
#include <TopExp_Explorer.hxx>
#include <TopLoc_Location.hxx>

namespace teracell::step {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// With its gap, in which the kernel keeps how far a loose box may be off; what AddOptimal() finds has a gap for its tolerance alone.
Box of(Bnd_Box box, bool with_gap) {
  Box out;
  if (!with_gap) box.SetGap(0);
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

double longest_column(const Matrix& m) {
  double out = 0;
  for (size_t d = 0; d < 3; ++d) out = std::max(out, std::sqrt(m[d] * m[d] + m[4 + d] * m[4 + d] + m[8 + d] * m[8 + d]));
  return out;
}

// The columns of the linear part, divided by their common length, which is negative where they mirror. False where the matrix is no rotation times a
// scale: then the box of what it moves is that of the moved corners.
bool split(const Matrix& m, std::array<double, 9>& rotation, double& scale) {
  scale = std::sqrt(m[0] * m[0] + m[4] * m[4] + m[8] * m[8]);
  if (!(scale > 0)) return false;
  if (m[0] * (m[5] * m[10] - m[6] * m[9]) - m[1] * (m[4] * m[10] - m[6] * m[8]) + m[2] * (m[4] * m[9] - m[5] * m[8]) < 0) scale = -scale;
  for (size_t row = 0; row < 3; ++row)
    for (size_t d = 0; d < 3; ++d) rotation[3 * row + d] = m[4 * row + d] / scale;
  const auto& r = rotation;
  for (size_t a = 0; a < 3; ++a)
    for (size_t b = 0; b < 3; ++b)
      if (std::abs(r[a] * r[b] + r[3 + a] * r[3 + b] + r[6 + a] * r[6 + b] - (a == b ? 1 : 0)) > 1e-9) return false;
  return true;
}

// Whether each axis becomes an axis.
bool keeps_axes(const Matrix& m) {
  for (size_t row = 0; row < 3; ++row)
    if ((m[4 * row] != 0) + (m[4 * row + 1] != 0) + (m[4 * row + 2] != 0) > 1) return false;
  return true;
}

constexpr std::array<double, 9> kUnturned = {1, 0, 0, 0, 1, 0, 0, 0, 1};
constexpr Box kNowhere = {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

constexpr double kTolerances = 2.1e-7;  // two of the kernel's, and their rounding: of a face and of its edges, in the kernel's unit

// A box that is known to hold something, which may be smaller by more than `slack`.
struct Loose {
  Box box;
  double slack;
};

// The box of all items, of which loose boxes are known. Tight boxes cost much, so on each side only those items get one, by tight(i), whose loose
// box reaches further than what is known by more than the kernel's own tolerance, which is in all loose boxes: else every face that ends at the
// same plane would get one, and of a plate with 900 holes that takes longer than the facets.
template <class Tight>
Box around_all(const std::vector<Loose>& loose, Tight&& tight) {
  Box out = kNowhere;
  std::vector<bool> done(loose.size());
  std::vector<size_t> order(loose.size());
  for (size_t side = 0; side < 6; ++side) {
    const size_t d = side % 3;
    const auto reach_of = [&](const Box& b) { return side < 3 ? -b.lo[d] : b.hi[d]; };
    const auto reach = [&](const Loose& l) { return reach_of(l.box) - l.slack; };
    std::iota(order.begin(), order.end(), size_t{0});
    std::ranges::stable_sort(order, [&](size_t a, size_t b) { return reach(loose[a]) > reach(loose[b]); });
    for (const size_t i : order) {
      if (reach(loose[i]) <= reach_of(out)) break;
      if (!done[i]) extend(out, tight(i));
      done[i] = true;
    }
  }
  return out;
}

}  // namespace

const Boxes::Faces& Boxes::faces_of(uint32_t shape) {
  const auto [known, fresh] = faces_.try_emplace(shape);
  Faces& faces = known->second;
  if (!fresh) return faces;
  faces.all = kNowhere;
  for (TopExp_Explorer face(model_.shapes[shape].shape, TopAbs_FACE); face.More(); face.Next()) {
    Bnd_Box box;
    BRepBndLib::Add(face.Current(), box, false);
    if (box.IsVoid()) continue;
    faces.list.push_back(face.Current());
    faces.loose.push_back(of(box, true));
    extend(faces.all, faces.loose.back());
  }
  return faces;
}

Box Boxes::tight(const Instance& instance) {
  std::array<double, 9> r;
  double scale = 1;
  const bool turned = !keeps_axes(instance.matrix) && split(instance.matrix, r, scale);
  if (!turned) r = kUnturned;
  const auto [known, fresh] = tight_.try_emplace({instance.shape, r});
  if (fresh) {
    const Faces& faces = faces_of(instance.shape);
    gp_Trsf turn;
    if (turned) turn.SetValues(r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0);
    turn.SetScaleFactor(1);  // within the kernel's tolerance it is 1 already
    std::vector<Loose> loose;
    for (const Box& b : faces.loose)
      loose.push_back({turned ? moved(b, {r[0], r[1], r[2], 0, r[3], r[4], r[5], 0, r[6], r[7], r[8], 0}) : b, kTolerances});
    known->second = around_all(loose, [&](size_t i) {
      Bnd_Box box;
      BRepBndLib::AddOptimal(turned ? faces.list[i].Moved(TopLoc_Location(turn)) : faces.list[i], box, false, false);
      return box.IsVoid() ? loose[i].box : of(box, false);
    });
  }
  if (!turned) return moved(known->second, instance.matrix);
  const Matrix& m = instance.matrix;
  return moved(known->second, {scale, 0, 0, m[3], 0, scale, 0, m[7], 0, 0, scale, m[11]});
}

Box Boxes::around(const std::vector<Instance>& instances) {
  std::vector<Loose> loose;
  loose.reserve(instances.size());
  for (const Instance& i : instances)
    loose.push_back({faces_of(i.shape).list.empty() ? kNowhere : moved(faces_of(i.shape).all, i.matrix), kTolerances * longest_column(i.matrix)});
  return around_all(loose, [&](size_t i) { return tight(instances[i]); });
}

}  // namespace teracell::step
