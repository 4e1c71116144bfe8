#include "mesher/boundary/simple_rays.hpp"

#include <algorithm>
#include <bit>

#include "store/base/system/vector_units.hpp"

namespace teracell::mesher {
namespace {

// How many changes a simple ray may have: what is known of eight such rays takes 128 KiB.
constexpr uint32_t kMostChanges = 64;

// Numbers of eight rays at once. They are written out as vectors, since compilers leave most such loops as they are at -O2.
constexpr uint32_t kLanes = SimpleRays::kLanes;
using Lanes [[gnu::vector_size(32)]] = int32_t;
using FourLanes [[gnu::vector_size(16)]] = int32_t;

// A row of sub-rays, so many of each of eight rays, those of ray l from cells[begins[l]] on: take(i, lanes) gets those of the eight rays side by side
// that are number i of theirs.
template <class Take>
TERACELL_IN_LINE inline void turn_sub_rays(const uint32_t* cells, const size_t (&begins)[kLanes], uint32_t of_each, const Take& take) {
  constexpr uint32_t kFour = 4;
  if (of_each % kFour != 0) {
    for (uint32_t i = 0; i < of_each; ++i) {
      const auto cell = [&](uint32_t l) TERACELL_IN_LINE { return static_cast<int32_t>(cells[begins[l] + i]); };
      take(i, Lanes{cell(0), cell(1), cell(2), cell(3), cell(4), cell(5), cell(6), cell(7)});
    }
    return;
  }
  for (uint32_t i = 0; i < of_each; i += kFour) {
    FourLanes turned[2][kFour];  // of the lower four rays, and of the upper ones
    for (uint32_t half = 0; half < 2; ++half) {
      FourLanes r[kFour];
      for (uint32_t l = 0; l < kFour; ++l) __builtin_memcpy(&r[l], cells + begins[half * kFour + l] + i, sizeof r[l]);
      const FourLanes a = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5), b = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5);
      const FourLanes c = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7), d = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
      turned[half][0] = __builtin_shufflevector(a, b, 0, 1, 4, 5), turned[half][1] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
      turned[half][2] = __builtin_shufflevector(c, d, 0, 1, 4, 5), turned[half][3] = __builtin_shufflevector(c, d, 2, 3, 6, 7);
    }
    for (uint32_t k = 0; k < kFour; ++k) take(i + k, __builtin_shufflevector(turned[0][k], turned[1][k], 0, 1, 2, 3, 4, 5, 6, 7));
  }
}

// Whether words are all the same.
TERACELL_IN_LINE inline bool are_all(uint32_t word, const uint32_t* words, size_t size) {
  Lanes different = {};
  size_t i = 0;
  for (; i + kLanes <= size; i += kLanes) {
    Lanes x;
    __builtin_memcpy(&x, words + i, sizeof x);
    different |= x ^ static_cast<int32_t>(word);
  }
  for (; i < size; ++i) different[0] |= static_cast<int32_t>(words[i] ^ word);
  bool same = true;
  for (uint32_t l = 0; l < kLanes; ++l) same &= different[l] == 0;
  return same;
}

}  // namespace

void SimpleRays::find_none(uint32_t rays) {
  simple_.assign(rays, 0);
  alike_.clear(), spans_.clear();
  added_ = backgrounds_size_ = 0;
}

void SimpleRays::find(const Row& row) {
  find_none(row.size);
  const uint32_t* const patterns = row.runs.pattern.data() + row.first;
  for (uint32_t begin = 0; begin < row.size;) {
    uint32_t end = begin + 1;
    while (end < row.size && patterns[end] == patterns[begin]) ++end;
    begin = find_alike(row, begin, end);
  }
}

// The place of the first sub-ray of a ray in a plane.
size_t SimpleRays::corner_of(const Row& row, uint32_t ray) const { return size_t{row.row} * sv_ * row.sub_rays + size_t{ray} * su_; }

// Looks at rays from `begin` on, which have the same pattern up to `end`. Returns where the rays end that are decided.
uint32_t SimpleRays::find_alike(const Row& row, uint32_t begin, uint32_t end) {
  const auto sets = row.runs.sets(row.first + begin);
  const auto changes = static_cast<uint32_t>(sets.size()) - 1;
  if (changes > kMostChanges) return end;
  const Label label = changes == 0 ? 0 : sets[1];
  for (uint32_t i = 0; i <= changes; ++i)
    if (changes % 2 != 0 || sets[i] != (i % 2 == 0 ? 0 : label)) return end;
  const size_t corner = corner_of(row, begin), all = size_t{end - begin} * su_;
  for (uint32_t j = 0; j < sv_; ++j) {
    const uint8_t* const counts = row.planes.counts.data() + corner + size_t{j} * row.sub_rays;
    uint32_t different = 0;
    on_vector_unit([=, &different]() TERACELL_IN_LINE {
      uint8_t of_any = 0;
      for (size_t i = 0; i < all; ++i) of_any |= static_cast<uint8_t>(counts[i] ^ changes);
      different = of_any;
    });
    for (uint32_t i = 0; different != 0 && i < (end - begin) * su_; ++i)
      if (counts[i] != changes) end = begin + i / su_;
  }
  if (end == begin) return begin + 1;
  Alike rays{begin, end, changes, label, spans_.size(), 0};
  if (changes > 0) {
    if (label_of_layer_[Crossing::layer(row.planes.crossing(corner, 0))] != label) return end;
    count(row, rays);
  } else {
    std::fill(simple_.begin() + begin, simple_.begin() + end, 1);
  }
  alike_.push_back(rays);
  return end;
}

// Counts the sub-samples of the rays' cells, and finds which of them are simple.
void SimpleRays::count(const Row& row, Alike& rays) {
  const uint32_t su = su_, sv = sv_, size = rays.end - rays.begin, changes = rays.changes;
  const auto per_ray = static_cast<int32_t>(per_ray_), total = static_cast<int32_t>(su * sv * per_ray_), length = row.length;
  const int shift = std::countr_zero(per_ray_);
  const size_t corner = corner_of(row, rays.begin), row_size = row.sub_rays, stride = row.planes.stride, blocks = (size + kLanes - 1) / kLanes;
  const size_t most_counts = size_t{changes} * kMostCells * kLanes;
  const uint32_t* const ends = row.runs.at.data() + row.runs.begin[row.first + rays.begin];
  spans_.resize(rays.spans + blocks * changes);
  places_.resize(size_t{su} * sv * kLanes);
  int32_t* const places = places_.data();
  const uint32_t* const sub_cells = row.planes.cells.data() + corner;
  const uint32_t* const layers = row.planes.layer_of_all ? nullptr : row.planes.layers.data() + corner;
  const uint32_t first_turn = sub_cells[0] & CrossingPlanes::kUp;
  for (size_t block = 0; block < blocks; ++block) {
    Spans* const spans = spans_.data() + rays.spans + block * changes;
    const size_t counts_begin = backgrounds_size_;
    if (backgrounds_.size() < counts_begin + most_counts) backgrounds_.resize(2 * (counts_begin + most_counts));
    int32_t* const backgrounds = backgrounds_.data() + counts_begin;
    uint8_t* const simple = simple_.data() + rays.begin + block * kLanes;
    const uint32_t first = static_cast<uint32_t>(block) * kLanes, width = std::min(kLanes, size - first);
    size_t used = 0;
    uint32_t of_block = 0;  // mixed cells
    on_vector_unit([=, &used, &of_block]() TERACELL_IN_LINE {
      for (uint32_t n = 0; layers && n < changes; ++n)
        for (uint32_t j = 0; j < sv; ++j)
          if (!are_all(layers[0], layers + n * stride + j * row_size + size_t{first} * su, size_t{width} * su)) return;

      uint32_t ray[kLanes];
      size_t sub_rays[kLanes];
      for (uint32_t l = 0; l < kLanes; ++l) ray[l] = std::min(first + l, size - 1), sub_rays[l] = size_t{ray[l]} * su;
      const Lanes zero = {}, all_of_one = zero + per_ray, all = zero + total;
      Lanes before = zero, good = ~zero, mixed = zero;
      size_t counts = 0;
      for (uint32_t n = 0; n < changes; ++n) {
        // The crossings go up and down by turns. What does not lies behind the end of its ray.
        const Lanes turn = zero + static_cast<int32_t>(n % 2 == 0 ? first_turn : first_turn ^ CrossingPlanes::kUp);
        Lanes least = zero + INT32_MAX, greatest = zero;
        for (uint32_t j = 0; j < sv; ++j)
          turn_sub_rays(sub_cells + n * stride + j * row_size, sub_rays, su, [&](uint32_t i, Lanes p) TERACELL_IN_LINE {
            p ^= turn;
            __builtin_memcpy(places + (size_t{j} * su + i) * kLanes, &p, sizeof p);
            least = p < least ? p : least, greatest = p > greatest ? p : greatest;
          });
        const auto change = [&](uint32_t l) TERACELL_IN_LINE { return static_cast<int32_t>(ends[ray[l] * changes + n]); };
        const Lanes end = {change(0), change(1), change(2), change(3), change(4), change(5), change(6), change(7)};
        const Lanes from = least >> shift, to = (greatest + (per_ray - 1)) >> shift, cells = to - from;
        good &= (least > 0) & (greatest < length) & (end >= from) & (end <= to) & (cells <= static_cast<int32_t>(kMostCells)) & (from >= before);
        before = to;
        mixed += good & cells;
        __builtin_memcpy(spans[n].from, &from, sizeof from);
        __builtin_memcpy(spans[n].to, &to, sizeof to);
        spans[n].counts = counts_begin + counts;
        int32_t most = 0;
        for (uint32_t l = 0; l < kLanes; ++l) most = std::max(most, good[l] ? cells[l] : 0);
        Lanes cell_end = (from + 1) << shift, latest = zero - 1, has_equal = zero;
        for (int32_t cell = 0; cell < most; ++cell, cell_end += per_ray, counts += kLanes) {
          // Of each sub-ray what lies behind its change.
          Lanes sum = zero;
          for (uint32_t s = 0; s < su * sv; ++s) {
            Lanes p;
            __builtin_memcpy(&p, places + size_t{s} * kLanes, sizeof p);
            p = cell_end - p;
            p = p < zero ? zero : p;
            sum += p > all_of_one ? all_of_one : p;
          }
          has_equal |= (sum == latest) & (cell < cells);
          latest = sum;
          const Lanes background = n % 2 == 0 ? all - sum : sum;
          __builtin_memcpy(backgrounds + counts, &background, sizeof background);
        }
        __builtin_memcpy(spans[n].has_equal, &has_equal, sizeof has_equal);
      }
      for (uint32_t l = 0; l < width; ++l) simple[l] = good[l] != 0;
      used = counts;
      for (uint32_t l = 0; l < width; ++l) of_block += static_cast<uint32_t>(mixed[l]);
    });
    backgrounds_size_ += used;
    rays.cells += of_block;
  }
}

uint32_t SimpleRays::add(uint32_t begin, MixedCells& out) {
  while (alike_[added_].end <= begin) ++added_;
  uint32_t end = begin;
  while (end < alike_[added_].end && simple_[end]) ++end;
  append(alike_[added_], begin, end, out);
  return end;
}

void SimpleRays::append(const Alike& rays, uint32_t begin, uint32_t end, MixedCells& out) const {
  if (rays.cells == 0) {
    out.begin.insert(out.begin.end(), end - begin, static_cast<uint32_t>(out.stretches.size()));
    return;
  }
  constexpr uint32_t kFew = 4;  // cells of a change. Most have two or three, and no processor foresees which, so four are always written
  const uint32_t labels[2] = {0, rays.label}, first = begin - rays.begin, last = end - rays.begin, changes = rays.changes,
                 total = su_ * sv_ * per_ray_;
  const uint32_t runs_before = out.runs;
  const size_t stretches_before = out.stretches.size(), counts_before = out.counts.size();
  out.stretches.resize(stretches_before + size_t{last - first} * changes + 1);
  out.counts.resize(counts_before + 2 * (size_t{rays.cells} + kFew));
  MixedCells::Stretch *const stretches = out.stretches.data(), *stretch = stretches + stretches_before;
  uint32_t *const counts = out.counts.data() + counts_before, *count = counts;
  uint32_t run = runs_before;
  for (uint32_t ray = first; ray < last; ++ray) {
    const Spans* const spans = spans_.data() + rays.spans + size_t{ray / kLanes} * changes;
    const uint32_t lane = ray % kLanes;
    uint32_t latest_end = ~uint32_t{0};  // of the latest run of the ray
    for (uint32_t n = 0; n < changes; ++n) {
      const int32_t* const backgrounds = backgrounds_.data() + spans[n].counts + lane;
      const auto from = static_cast<uint32_t>(spans[n].from[lane]), to = static_cast<uint32_t>(spans[n].to[lane]), cells = to - from;
      if (cells == 0) continue;
      const bool goes_on = from == latest_end;  // then the background of the run before this one is count[-2]
      *stretch = {from, run};
      stretch += !goes_on;
      latest_end = to;
      if (cells <= kFew) {
        const FourLanes b = {backgrounds[0], backgrounds[size_t{kLanes}], backgrounds[size_t{2} * kLanes], backgrounds[size_t{3} * kLanes]};
        const FourLanes rest = static_cast<int32_t>(total) - b;
        const FourLanes lower = __builtin_shufflevector(b, rest, 0, 4, 1, 5), upper = __builtin_shufflevector(b, rest, 2, 6, 3, 7);
        if (spans[n].has_equal[lane] == 0 && !(goes_on && static_cast<uint32_t>(backgrounds[0]) == count[-2])) {
          __builtin_memcpy(count, &lower, sizeof lower);
          __builtin_memcpy(count + kFew, &upper, sizeof upper);
          run += cells, count += size_t{2} * cells;
          continue;
        }
      }
      bool has_latest = goes_on;
      for (uint32_t k = 0; k < cells; ++k, has_latest = true) {
        const auto b = static_cast<uint32_t>(backgrounds[size_t{k} * kLanes]);
        if (has_latest && b == count[-2]) {
          out.lengthen(run - 1, 1);
          continue;
        }
        *count++ = b, *count++ = total - b;
        ++run;
      }
    }
    out.begin.push_back(static_cast<uint32_t>(stretch - stretches));
  }
  out.stretches.resize(static_cast<size_t>(stretch - stretches));
  out.counts.resize(counts_before + static_cast<size_t>(count - counts));
  if (run > runs_before) out.name_set(run - runs_before, out.sets.intern(labels), counts_before);
}

}  // namespace teracell::mesher
