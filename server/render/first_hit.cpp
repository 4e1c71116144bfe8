#include "server/render/first_hit.hpp"

#include <cmath>
#include <limits>

namespace teracell::server {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kParallel = 1e-290;  // what is less counts as 0, so that the inverse is finite

double widest_cell(const Axis& axis) {
  if (!axis.is_graded()) return axis.step();
  double widest = 0;
  for (size_t i = 0; i + 1 < axis.planes().size(); ++i) widest = std::max(widest, axis.planes()[i + 1] - axis.planes()[i]);
  return widest;
}

}  // namespace

FirstHits::FirstHits(const Subject& subject, const Camera& camera)
    : subject_(subject),
      camera_(camera),
      grid_(subject.viewed.reader.meta().grid),
      cells_(grid_.cells()),
      frame_(subject.viewed.reader.meta().frame()),
      shown_(subject.viewed.reader, subject.visible) {
  const GridReader& reader = subject.viewed.reader;
  if (subject.viewed.against) differing_ = std::make_unique<Differing>(reader, *subject.viewed.against, subject.visible.shows_damage());
  const int drawn = subject.level.value_or(0);
  double widest = 0;
  for (const Axis& axis : grid_.axis) widest = std::max(widest, widest_cell(axis));
  // A level that is not stored is only worth its price when it is what is drawn.
  for (int level = reader.levels() - 1; level >= 0; --level)
    if (level == drawn || level >= subject.occupancy.level() || reader.stored(level)) {
      if (level == drawn) drawn_ = rungs_.size();
      rungs_.push_back(reader.shape(level));
      widest_.push_back(std::ldexp(widest, level));
    }
}

double FirstHits::time(int axis, int64_t plane) const {
  const double p = grid_.axis[axis].plane(plane), from = line_.sight.from[axis];
  // The domain's max belongs to the last cell.
  if (line_.sight.along[axis] == 0) return p < from || (p == from && plane < cells_[axis]) ? -kInfinity : kInfinity;
  return (p - from) * line_.inverse[axis];
}

// To the domain, and to what is not cut away.
void FirstHits::clip() {
  Stretch all{0, kInfinity, -1};
  for (int d = 0; d < 3; ++d) {
    double enter = time(d, 0), leave = time(d, cells_[d]);
    if (line_.sight.along[d] < 0) std::swap(enter, leave);
    if (enter > all.begin) all.begin = enter, all.face = d;
    all.end = std::min(all.end, leave);
  }
  stretches_.clear();
  if (all.begin < all.end) stretches_.push_back(all);
  int plane = 0;
  for (const Cut& cut : subject_.cuts) {
    remove(cut, plane);
    plane += static_cast<int>(cut.size());
  }
}

// `plane`: the number of the cut's first plane.
void FirstHits::remove(const Cut& cut, int plane) {
  double from = -kInfinity, to = kInfinity;  // of the line, what is cut away
  int face = -1;                             // where it ends
  for (size_t i = 0; i < cut.size(); ++i) {
    const double along = dot(cut[i].normal, line_.sight.along), off = cut[i].offset - dot(cut[i].normal, line_.sight.from);
    if (std::abs(along) < kParallel) {
      if (off > 0) return;
      continue;
    }
    const double t = off * (1 / along);
    if (along > 0) from = std::max(from, t);
    else if (t < to) to = t, face = 3 + plane + static_cast<int>(i);
  }
  if (from >= to) return;
  shorter_.clear();
  for (const Stretch& s : stretches_) {
    if (s.begin < std::min(s.end, from)) shorter_.push_back({s.begin, std::min(s.end, from), s.face});
    if (std::max(s.begin, to) < s.end) shorter_.push_back({std::max(s.begin, to), s.end, s.begin < to ? face : s.face});
  }
  std::swap(stretches_, shorter_);
}

std::optional<Hit> FirstHits::first(const Sight& sight) {
  line_.sight = sight;
  for (int d = 0; d < 3; ++d) {
    if (std::abs(sight.along[d]) < kParallel) line_.sight.along[d] = 0;
    line_.inverse[d] = 1 / line_.sight.along[d];
  }
  hit_.reset();
  to_the_end_ = false;  // an error may have left it
  clip();
  for (const Stretch& s : stretches_) {
    line_.begin = s.begin, line_.face = s.face;
    if (occupied(0, {0, 0, 0}) && descend(0, {0, 0, 0}, s.begin, s.end)) break;
  }
  return hit_;
}

bool FirstHits::is_drawn(size_t rung, double t) const {
  if (rung + 1 == rungs_.size()) return true;
  if (to_the_end_) return false;
  return subject_.level ? rung == drawn_ : widest_[rung] <= camera_.finest_at(t);
}

// Looks for the first visible cell in an occupied one, through which the line goes from t0 to t1.
bool FirstHits::descend(size_t rung, const Index3& cell, double t0, double t1) {
  return is_drawn(rung, t0) ? take(rung, cell, t0, t1) : pass(rung, cell, t0, t1);
}

// Looks for it among the finer cells.
bool FirstHits::pass(size_t rung, const Index3& cell, double t0, double t1) {
  const int level = rungs_[rung + 1].level, shift = rungs_[rung].level - level;
  Index3 at, last, step;
  Vec3 leave;
  const auto time_to_leave = [&](int d) { return time(d, std::min((at[d] + (step[d] > 0)) << level, cells_[d])); };
  for (int d = 0; d < 3; ++d) {
    const int64_t lo = cell[d] << shift, hi = std::min((cell[d] + 1) << shift, ceil_shift(cells_[d], level)) - 1;
    const bool forward = line_.sight.along[d] >= 0;
    step[d] = forward ? 1 : -1, at[d] = forward ? lo : hi, last[d] = forward ? hi : lo;
    for (leave[d] = time_to_leave(d); leave[d] <= t0 && at[d] != last[d]; leave[d] = time_to_leave(d)) at[d] += step[d];
  }
  for (;;) {
    const double next = std::min({leave[0], leave[1], leave[2], t1});
    if (t0 < next && occupied(rung + 1, at) && descend(rung + 1, at, t0, next)) return true;
    if (next >= t1) return false;
    for (int d = 0; d < 3; ++d) {
      if (leave[d] > next) continue;
      if (at[d] == last[d]) return false;
      at[d] += step[d];
      leave[d] = time_to_leave(d);
    }
    t0 = std::max(t0, next);
  }
}

// A cell that is drawn. If several of its labels are visible, that which is seen of them; where the line meets none of them, the strongest.
bool FirstHits::take(size_t rung, const Index3& cell, double t0, double t1) {
  const uint32_t of = seen(rung, cell);
  if (of == 0 || of == Differing::kAlike) return false;
  const bool is_damaged = of == Visible::kDamaged, is_last = rung + 1 == rungs_.size();
  if (is_damaged && !is_last) return pass(rung, cell, t0, t1);  // what can't be read on one level may be known on the next one
  if (of == Visible::kSeveral && !is_last) {
    to_the_end_ = true;
    const bool found = descend(rung, cell, t0, t1);
    to_the_end_ = false;
    if (found || differing_) return found;
  }
  hit_ = Hit{t0,
             is_damaged                ? subject_.visible.damage()
             : of == Visible::kSeveral ? strongest(rung, cell)
                                       : of - 1,
             face_of(rung, cell, t0), cell, rungs_[rung].level};
  return true;
}

int FirstHits::face_of(size_t rung, const Index3& cell, double t0) const {
  if (t0 == line_.begin) return line_.face;
  int face = 0;
  double latest = -kInfinity;
  for (int d = 0; d < 3; ++d) {
    const bool forward = line_.sight.along[d] >= 0;
    const double enter = time(d, std::min((cell[d] + !forward) << rungs_[rung].level, cells_[d]));
    if (enter > latest) latest = enter, face = d;
  }
  return face;
}

bool FirstHits::occupied(size_t rung, const Index3& cell) {
  if (const int level = rungs_[rung].level; level >= subject_.occupancy.level())
    return subject_.occupancy.at(level, static_cast<uint32_t>(cell[frame_.u]), static_cast<uint32_t>(cell[frame_.v]),
                                 static_cast<uint32_t>(cell[frame_.w]));
  return seen(rung, cell) != 0;
}

// Visible::of() the set of a cell.
uint32_t FirstHits::seen(size_t rung, const Index3& cell) {
  const int level = rungs_[rung].level;
  return differing_ ? differing_->at(level, cell) : shown_.at(level, cell);
}

Label FirstHits::strongest(size_t rung, const Index3& cell) {
  std::vector<Label> set = shown_.labels(rungs_[rung].level, cell);
  std::erase_if(set, [&](Label label) { return !subject_.visible(label); });
  const Metadata& meta = subject_.viewed.reader.meta();
  return *std::ranges::min_element(set, {}, [&](Label label) { return meta.materials[meta.labels[label].material].rank; });
}

}  // namespace teracell::server
