#include "mesher/compose/compose.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/system/vector_units.hpp"

namespace teracell::mesher {
namespace {

constexpr uint32_t kNowhere = ~uint32_t{0};  // no cell, no rank

// Sorts the crossings of a ray. The engine leaves them nearly in order and they are few, so insertion takes one comparison per
// crossing. Returns whether all are of one layer. That is found out here because a second loop would wait for the crossings
// that were just stored (it took a tenth of the whole run).
bool sort_crossings(std::span<uint64_t> c) {
  if (c.empty()) return true;
  const uint64_t first = c[0];
  uint64_t mixed = 0;
  if (c.size() > 64) {
    for (const uint64_t x : c) mixed |= x ^ first;
    std::ranges::sort(c);
  } else {
    for (size_t i = 1; i < c.size(); ++i) {
      const uint64_t x = c[i];
      mixed |= x ^ first;
      size_t j = i;
      for (; j > 0 && c[j - 1] > x; --j) c[j] = c[j - 1];
      c[j] = x;
    }
  }
  return Crossing::layer(mixed) == 0;
}

// Goes through `rays` rays of n crossings each as long as those of a ray are sorted, all of that layer and no marks, up and down
// by turns, in cells that are all different and not the first one. Then each crossing is a change, whatever the fill rule. Writes the changes
// at `at`, adds the cells between them to `cells`, and returns how many rays are so. There is no branch but one for each ray.
template <class Count>
uint32_t take_turns(const uint64_t* c, Count n, uint32_t rays, uint32_t layer, uint32_t length, uint32_t* at, int64_t& cells) {
  for (uint32_t ray = 0; ray < rays; ++ray, c += n, at += n) {
    uint32_t before = at[0] = Crossing::cell(c[0]), differences = (static_cast<uint32_t>(c[0]) >> 1) ^ layer;
    bool ascending = before > 0;
    int64_t within = -int64_t{before};
    for (uint32_t i = 1; i < n; ++i) {
      differences |= static_cast<uint32_t>(c[i] ^ c[i - 1]) ^ 1;  // of layer, mark and direction: all but the direction
      const uint32_t cell = at[i] = Crossing::cell(c[i]);
      ascending &= cell > before;
      within += i % 2 == 0 ? -int64_t{cell} : int64_t{cell};
      before = cell;
    }
    if (differences != 0 || !ascending || before >= length) return ray;
    cells += within;
  }
  return rays;
}

// The same for two crossings of each ray, some rays at once by vectors. Stops before the rays that are not all so, and before the last few.
uint32_t take_pairs(const uint64_t* c, uint32_t rays, uint32_t layer, uint32_t length, uint32_t* at, int64_t& cells) {
  constexpr uint32_t kRays = 16;
  uint32_t taken = 0;
  int64_t within = 0;
  on_vector_unit([&, c, rays, at, of_layer = uint64_t{layer} << 1, end = int64_t{length}]() TERACELL_IN_LINE {
    uint32_t ray = 0;
    for (; ray + kRays <= rays; ray += kRays) {
      const uint64_t* const pairs = c + size_t{2} * ray;
      uint32_t* const out = at + size_t{2} * ray;
      uint64_t wrong[kRays];
      int64_t between[kRays];
#pragma GCC unroll 1
      for (size_t i = 0; i < kRays; ++i) {
        const uint64_t first = pairs[2 * i], second = pairs[2 * i + 1];
        const auto lo = static_cast<int64_t>(first >> 32), hi = static_cast<int64_t>(second >> 32);
        out[2 * i] = static_cast<uint32_t>(lo), out[2 * i + 1] = static_cast<uint32_t>(hi);
        wrong[i] =
            ((first ^ of_layer) & 0xfffffffe) | ((first ^ second ^ 1) & 0xffffffff) | uint64_t{lo == 0} | uint64_t{hi <= lo} | uint64_t{hi >= end};
        between[i] = hi - lo;
      }
      uint64_t any = 0;
      int64_t sum = 0;
      for (uint32_t i = 0; i < kRays; ++i) any |= wrong[i], sum += between[i];
      if (any != 0) break;
      within += sum;
    }
    taken = ray;
  });
  cells += within;
  return taken;
}

// Rays of more crossings have no course; nor have those that are in more bodies where they leave one, added up over all that they leave. Each thread
// has courses, which take memory.
constexpr size_t kMostOfCourse = 256;

// Whether all that happens to the ray follows from the order of its crossings.
bool can_be_learnt(std::span<const uint64_t> sorted, uint32_t length) {
  uint64_t marks = 0;
  for (const uint64_t c : sorted) marks |= c & Crossing::kMark;
  return !sorted.empty() && sorted.size() <= kMostOfCourse && marks == 0 && Crossing::cell(sorted.back()) <= length;
}

// Where the course of a ray is kept: by the order of its crossings.
size_t place_of(std::span<const uint64_t> sorted) {
  uint32_t hash = 0, factor = 1;  // no product waits for the one before
  for (const uint64_t c : sorted) hash += static_cast<uint32_t>(c) * factor, factor += 0x9E3779B2;
  return hash * 0x85EBCA6Bu >> (32 - Composer::kCourseBits);
}

// A crossing without its cell, but with whether that is the cell of the crossing before it.
uint64_t without_cell(uint64_t crossing, uint32_t cell_before) {
  return uint64_t{Crossing::cell(crossing) == cell_before} << 32 | static_cast<uint32_t>(crossing);
}

}  // namespace

Composer::Composer(std::vector<Layer> layers, const std::vector<uint32_t>& rank, const std::vector<Label>& label, const std::vector<Label>& in_others,
                   int ray_axis)
    : layers_(std::move(layers)), counter_(layers_.size(), 0), overlaps_(label.size(), ray_axis) {
  bodies_.reserve(label.size());
  for (uint32_t b = 0; b < label.size(); ++b) bodies_.push_back({rank[b], label[b], in_others[b]});
}

std::vector<BodyCells> Composer::take_cells() {
  for (Course& course : courses_) add_cells(course);
  std::vector<BodyCells> out;
  out.reserve(met_.size());
  for (const uint32_t b : met_) {
    Body& body = bodies_[b];
    out.push_back({b, static_cast<uint64_t>(body.owned), static_cast<uint64_t>(body.within - body.owned)});
    body.owned = body.within = 0;
    body.met = false;
  }
  met_.clear();
  return out;
}

std::vector<Inside>::iterator Composer::place_inside(uint32_t rank) {
  return std::ranges::lower_bound(inside_, rank, std::ranges::greater{}, &Inside::rank);
}

inline void Composer::enter(const Inside& body) {
  if (inside_.empty() || inside_.back().rank > body.rank) inside_.push_back(body);  // mostly
  else inside_.insert(place_inside(body.rank), body);
}

Bytes Composer::take_overlaps(const Box& cells) {
  for (Course* course : of_tile_) add_overlaps(*course);
  of_tile_.clear();
  return overlaps_.take(cells);
}

inline void Composer::leave(uint32_t rank, uint32_t cell) {
  const auto place = inside_.back().rank == rank ? inside_.end() - 1 : place_inside(rank);
  const Inside body = *place;
  inside_.erase(place);
  if (inside_.empty()) return;
  overlaps_.leave(body, cell, inside_, owner_, [&](uint32_t from) { return overlaps_.stretch(ray_, from, cell); });
  if (learning_ && body.from < cell) learn_leaving(body);
}

// `cell` is the crossing's cell, or the length of the ray if that is less.
void Composer::step(uint64_t crossing, uint32_t cell) {
  const uint32_t l = Crossing::layer(crossing);
  const Layer& layer = layers_[l];
  int& counter = counter_[l];
  const bool was = counter != 0;
  counter = layer.evenodd ? counter ^ 1 : counter + Crossing::step(crossing);
  const bool is = counter != 0;
  const bool mark = Crossing::is_mark(crossing);
  if (was == is && !mark) return;
  Body& body = meet(layer.body);
  if (mark) body.marks += Crossing::step(crossing);
  if (was != is) {
    open_ += is ? 1 : -1;
    body.layers = static_cast<uint16_t>(body.layers + (is ? 1 : -1));
    if (body.layers == is) {  // otherwise another layer of the body decides
      body.within += is ? -int64_t{cell} : int64_t{cell};
      if (learning_) learning_->turns[crossing_] = {layer.body, is ? 1 : -1};
      if (is) enter({body.rank, layer.body, body.marks > 0 ? kNowhere : cell, first_of_cell_});
      else leave(body.rank, cell);
    }
  }
  if (mark && body.marks == 0 && body.layers > 0) place_inside(body.rank)->from = cell;  // the ray is inside beyond the mark
}

void Composer::note_pairs(std::span<const uint64_t> crossings, uint32_t length) {
  const uint32_t cell = Crossing::cell(crossings[0]);
  if (cell == 0 || cell >= length) return;
  for (size_t i = 0; i < crossings.size();) {
    const size_t first = i;
    const uint32_t body = layers_[Crossing::layer(crossings[i])].body;
    while (i < crossings.size() && !Crossing::is_mark(crossings[i]) && layers_[Crossing::layer(crossings[i])].body == body) ++i;
    if (i == first) return;  // marks are sorted last
    if (i - first > 1) pairs_.push_back({ray_, cell, body, (i - first) / 2});
  }
}

void Composer::compose(Crossings& crossings, uint32_t nu, uint32_t nv, uint32_t length, RayBlock& out) {
  out.reset_in_place(nu, nv, length, crossings.all.size());  // as many changes at most
  alternating_.assign(2, {});
  ++tile_;
  pairs_.clear();
  overlaps_.begin_tile(nu);
  uint32_t* at = out.at.data();
  const uint32_t rays = out.rays();
  for (uint32_t ray = 0; ray < rays;) {
    const uint32_t first = ray, n = crossings.begin[ray + 1] - crossings.begin[ray];
    while (ray < rays && crossings.begin[ray + 1] - crossings.begin[ray] == n) ++ray;
    compose_alike(crossings, first, ray, length, at, out);
  }
  out.at.resize(at - out.at.data());
}

void Composer::compose_alike(Crossings& crossings, uint32_t from, uint32_t to, uint32_t length, uint32_t*& at, RayBlock& out) {
  const uint32_t n = crossings.begin[from + 1] - crossings.begin[from];
  while (from < to) {
    const uint32_t simple = compose_turns(crossings.all.data() + crossings.begin[from], n, to - from, length, at, out.patterns);
    if (simple > 0) {
      std::fill_n(out.pattern.begin() + from, simple, turns_);
      auto end = static_cast<uint32_t>(at - out.at.data());
      for (const uint32_t last = from + simple; from < last; ++from) out.begin[from + 1] = end += n;
      at = out.at.data() + end;
      continue;
    }
    const std::span<uint64_t> all(crossings.all.data() + crossings.begin[from], n);
    ray_ = from;
    const size_t open = sort_crossings(all) && bodies_[layers_[Crossing::layer(all[0])].body].label != 0
                            ? compose_one_layer(all, length, at, out.pattern[from], out.patterns)
                            : compose_any(all, length, at, out.pattern[from], out.patterns);
    if (open != 0)
      throw Error(
          fmt::format("ray {}, {} of a tile ends inside {} of its surfaces: the crossings are inconsistent", from % out.nu, from / out.nu, open));
    out.begin[++from] = static_cast<uint32_t>(at - out.at.data());
  }
}

// Most rays with crossings are like that.
uint32_t Composer::compose_turns(const uint64_t* c, uint32_t n, uint32_t rays, uint32_t length, uint32_t* at, PatternTable& patterns) {
  if (n == 0) {
    turns_ = alternating_pattern(0, false, 0, patterns);
    return rays;
  }
  const uint32_t layer = Crossing::layer(c[0]), number = layers_[layer].body;
  if (n % 2 != 0 || bodies_[number].label == 0 || Crossing::is_mark(c[0])) return 0;
  int64_t cells = 0;
  uint32_t simple = 0;
  if (n == 2) {
    simple = take_pairs(c, rays, layer, length, at, cells);
    c += size_t{2} * simple;
    simple += take_turns(c, std::integral_constant<uint32_t, 2>(), rays - simple, layer, length, at + size_t{2} * simple, cells);
  } else if (n == 4) {
    simple = take_turns(c, std::integral_constant<uint32_t, 4>(), rays, layer, length, at, cells);
  } else {
    simple = take_turns(c, n, rays, layer, length, at, cells);
  }
  if (simple == 0) return 0;
  Body& body = meet(number);
  body.owned += cells, body.within += cells;
  turns_ = alternating_pattern(body.label, false, n, patterns);
  return simple;
}

// The pattern for a label, for how the ray begins, and for the number of changes, is looked up once.
uint32_t Composer::alternating_pattern(Label label, bool begins_inside, size_t changes, PatternTable& patterns) {
  std::vector<Alternating>& known = alternating_[begins_inside];
  if (known.size() <= changes) known.resize(changes + 1);
  Alternating& k = known[changes];
  if (k.pattern == ~0u || k.label != label) {
    sets_.clear();
    for (size_t i = 0; i <= changes; ++i) sets_.push_back((i % 2 == 0) == begins_inside ? label : 0);
    k = {label, patterns.intern(sets_)};
  }
  return k.pattern;
}

// Nearly all rays have one layer only. Then background and body alternate, and the pattern follows from the number of changes.
size_t Composer::compose_one_layer(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns) {
  uint32_t* const first = at;
  bool begins_inside = false, was = false;
  int counter = 0;
  int64_t cells = 0;
  const Layer layer = all.empty() ? Layer{0, false} : layers_[Crossing::layer(all[0])];
  for (size_t i = 0; i < all.size();) {
    const size_t begin = i;
    const uint32_t cell = Crossing::cell(all[i]);
    do counter += Crossing::step(all[i++]);
    while (i < all.size() && Crossing::cell(all[i]) == cell);
    if (i - begin > 1) note_pairs(all.subspan(begin, i - begin), length);
    const bool is = layer.evenodd ? counter & 1 : counter != 0;
    if (is == was || cell >= length) continue;
    was = is;
    cells += is ? -int64_t{cell} : int64_t{cell};
    if (cell == 0) begins_inside = true;
    else *at++ = cell;
  }
  const auto changes = static_cast<size_t>(at - first);
  if (was) cells += length;
  Label label = 0;
  if (changes > 0 || begins_inside) {
    Body& body = meet(layer.body);
    body.owned += cells, body.within += cells;
    label = body.label;
  }
  pattern = alternating_pattern(label, begins_inside, changes, patterns);
  return layer.evenodd ? counter & 1 : counter != 0;
}

// Of the cell whose crossings were the last to be stepped. Bodies that only keep it are not among those that its sample point lies in.
inline Label Composer::label_here() const {
  if (inside_.empty()) return 0;
  const Body& owner = bodies_[inside_.back().body];
  if (owner.label == owner.in_others) return owner.label;
  int bodies = 0;
  for (auto body = inside_.rbegin(); body != inside_.rend() && bodies < 2; ++body) bodies += body->from != kNowhere;
  return bodies < 2 ? owner.label : owner.in_others;
}

size_t Composer::compose_any(std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern, PatternTable& patterns) {
  // Four of five rays take the same course as the one before.
  bool known = latest_->takes(all, length);
  if (!known) {
    latest_ = &courses_[place_of(all)];
    known = latest_->takes(all, length);
  }
  if (known) {
    compose_again(*latest_, all, length, at, pattern, patterns);
    return 0;
  }
  Course& course = *latest_;
  learning_ = nullptr;
  if (can_be_learnt(all, length)) {
    add_cells(course);
    add_overlaps(course);
    learning_ = &course;
    course.known = false;
    course.changes.clear(), course.leaving.clear(), course.others.clear(), course.stretches.clear(), course.shared.clear();
    course.order.resize(all.size());
    for (size_t i = 0; i < all.size(); ++i) course.order[i] = without_cell(all[i], i == 0 ? 0 : Crossing::cell(all[i - 1]));
    course.reaches_end = Crossing::cell(all.back()) == length;
    course.owners.assign(all.size(), kNowhere);
    course.turns.assign(all.size(), {kNowhere, 0});
    course.cells.assign(all.size(), 0);
  }
  sets_.assign(1, 0);
  owner_ = {kNowhere, 0}, owner_crossing_ = 0;
  uint32_t since = 0;
  for (size_t i = 0; i < all.size();) {
    const uint32_t cell = Crossing::cell(all[i]), until = std::min(cell, length);
    if (!inside_.empty()) {
      bodies_[inside_.back().body].owned += until - since;
      if (learning_) learning_->owners[i] = inside_.back().body;
    }
    const size_t begin = i;
    if (until > since || i == 0) first_of_cell_ = static_cast<uint32_t>(i);
    since = until;
    for (; i < all.size() && Crossing::cell(all[i]) == cell; ++i) {
      crossing_ = static_cast<uint32_t>(i);
      step(all[i], until);
    }
    if (i - begin > 1) {
      note_pairs(all.subspan(begin, i - begin), length);
      if (learning_) learning_->shared.push_back({static_cast<uint32_t>(begin), static_cast<uint32_t>(i)});
    }
    if (cell >= length) continue;
    if (inside_.size() > 1 && inside_.back().rank != owner_.rank) owner_ = {inside_.back().rank, cell}, owner_crossing_ = first_of_cell_;
    const Label label = label_here();
    if (cell == 0) {
      sets_[0] = label;
    } else if (label != sets_.back()) {
      sets_.push_back(label);
      *at++ = cell;
      if (learning_) learning_->changes.push_back(crossing_);
    }
  }
  pattern = patterns.intern(sets_);
  if (learning_ && open_ == 0) {
    course.known = true;
    if (course.tile != tile_) of_tile_.push_back(&course);
    course.tile = tile_;
    course.pattern = pattern;
    course.sets = sets_;
  }
  learning_ = nullptr;
  return open_;
}

bool Composer::Course::takes(std::span<const uint64_t> sorted, uint32_t length) const {
  if (!known || order.size() != sorted.size()) return false;
  const uint32_t last = Crossing::cell(sorted.back());
  if (last > length || reaches_end != (last == length)) return false;
  uint64_t differences = 0;
  uint32_t before = 0;
  for (size_t i = 0; i < sorted.size(); ++i) {
    differences |= without_cell(sorted[i], before) ^ order[i];
    before = Crossing::cell(sorted[i]);
  }
  return differences == 0;
}

void Composer::compose_again(Course& course, std::span<const uint64_t> all, uint32_t length, uint32_t*& at, uint32_t& pattern,
                             PatternTable& patterns) {
  for (size_t i = 0; i < all.size(); ++i) course.cells[i] += Crossing::cell(all[i]);
  for (const uint32_t change : course.changes) *at++ = Crossing::cell(all[change]);
  for (const Course::Shared& s : course.shared) note_pairs(all.subspan(s.from, s.to - s.from), length);
  for (Course::Stretch& s : course.stretches) s.of_rays.add(overlaps_.stretch(ray_, Crossing::cell(all[s.from]), Crossing::cell(all[s.to])));
  if (course.tile != tile_) {
    course.pattern = patterns.intern(course.sets);
    course.tile = tile_;
    of_tile_.push_back(&course);
  }
  pattern = course.pattern;
  course.taken = true;
}

// Of the rays that took the course again.
void Composer::add_cells(Course& course) {
  if (!course.taken) return;
  course.taken = false;
  for (size_t i = 0; i < course.cells.size(); ++i) {
    const auto cells = static_cast<int64_t>(course.cells[i]);
    if (course.owners[i] != kNowhere) meet(course.owners[i]).owned += cells - static_cast<int64_t>(course.cells[i - 1]);
    if (course.turns[i].way != 0) meet(course.turns[i].body).within -= course.turns[i].way * cells;
  }
  std::ranges::fill(course.cells, 0);
}

// Hands on the stretches of the rays that took the course again.
void Composer::add_overlaps(Course& course) {
  for (const Course::Leaving& l : course.leaving) {
    const std::span<const Inside> others(course.others.begin() + l.first_other, course.others.begin() + l.end_other);
    const std::span<const Course::Stretch> stretches(course.stretches.begin() + l.first_stretch, course.stretches.begin() + l.end_stretch);
    if (stretches.empty() || stretches[0].of_rays.cells == 0) continue;
    overlaps_.leave(l.body, l.to, others, l.owner,
                    [&](uint32_t from) { return std::ranges::find(stretches, from, &Course::Stretch::from)->of_rays; });
  }
  for (Course::Stretch& s : course.stretches) s.of_rays = {};
}

// The body that the ray leaves at this crossing, and those that it stays inside of.
void Composer::learn_leaving(const Inside& body) {
  Course& course = *learning_;
  if (course.others.size() + inside_.size() > kMostOfCourse) {
    learning_ = nullptr;
    return;
  }
  Course::Leaving l{{body.rank, body.body, body.crossing}, first_of_cell_, course.others.size(), 0, course.stretches.size(), 0,
                    {owner_.rank, owner_crossing_}};
  for (const Inside& other : inside_) {
    course.others.push_back({other.rank, other.body, other.crossing});
    const uint32_t from = std::max(body.crossing, other.crossing);
    const std::span<const Course::Stretch> known(course.stretches.begin() + l.first_stretch, course.stretches.end());
    if (from < l.to && std::ranges::find(known, from, &Course::Stretch::from) == known.end()) course.stretches.push_back({from, l.to, {}});
  }
  l.end_other = course.others.size(), l.end_stretch = course.stretches.size();
  course.leaving.push_back(l);
}

}  // namespace teracell::mesher
