#include "store/check/thickness.hpp"

#include <algorithm>
#include <array>
#include <ranges>

namespace teracell::inline store {
namespace {

constexpr int kDeep2 = 20;   // cells up to this squared distance are inside where a centre is 4.5 cells deep
constexpr int kReach2 = 56;  // cells up to this squared distance are within 7.5 cells
constexpr int kLattice = 3;
constexpr uint32_t kUnknown = ~0u;
constexpr int kMargin = static_cast<int>(Field::kMargin);  // 7.5 cells to a centre, and 4.5 from there

constexpr int root(int square) {
  int out = 0;
  while ((out + 1) * (out + 1) <= square) ++out;
  return out;
}

// A ray beside a ray, and how many cells along it are within a distance of a cell of the other.
struct Beside {
  int u, v, reach;
};

const std::vector<Beside>& rays_within_depth() {
  static const std::vector<Beside> out = [] {
    std::vector<Beside> all;
    for (int v = -4; v <= 4; ++v)
      for (int u = -4; u <= 4; ++u)
        if (const int square = u * u + v * v; square > 0 && square <= kDeep2) all.push_back({u, v, root(kDeep2 - square)});
    return all;
  }();
  return out;
}

// The rays near a ray, the nearest first, by how far this one lies beyond every third ray along u and v. First those of every third row and column.
using BothNear = std::array<std::vector<Beside>, 2>;
const BothNear& rays_near(uint32_t ray_u, uint32_t ray_v) {
  static const auto out = [] {
    std::array<BothNear, size_t{kLattice} * kLattice> all;
    for (int i = 0; i < kLattice * kLattice; ++i)
      for (int v = -7; v <= 7; ++v)
        for (int u = -7; u <= 7; ++u) {
          const bool third = (u + i % kLattice) % kLattice == 0 && (v + i / kLattice) % kLattice == 0;
          if (const int square = u * u + v * v; square <= kReach2) all[i][third ? 0 : 1].push_back({u, v, root(kReach2 - square)});
        }
    for (auto& both : all)
      for (auto& near : both) std::ranges::stable_sort(near, {}, [](const Beside& b) { return b.u * b.u + b.v * b.v; });
    return all;
  }();
  return out[ray_v % kLattice * kLattice + ray_u % kLattice];
}

// A run, less `reach` cells at its ends. The domain's sides are no ends.
Thickness::Interval shrunk(uint32_t from, uint32_t to, int reach, uint32_t length) {
  const auto by = static_cast<uint32_t>(reach);
  return {from == 0 ? 0 : from + by, to == length ? to : to - std::min(to, by)};
}

// A block of cells, with a margin on each side: at most kTile rays along u and v, and kSlab cells.
constexpr int kTile = 32, kSlab = 32;
constexpr int kSide = kTile + 2 * kMargin;        // of the cells; corners are one more
constexpr int kRow = kSide + 1, kPlane = kRow * kRow, kBlock = kRow * kRow * kRow;
static_assert(kTile == kSlab);
constexpr int kBeyond = kMargin - 7;  // centres that are nearer to the block's ends are not near its cells
constexpr uint8_t kFar = 100;  // squared half cells: deeper is as deep as 9 half cells

// The thickness, in half cells, that a centre with this squared distance (in half cells) to the nearest cell outside allows.
constexpr std::array<uint8_t, kFar + 1> kAllowed = [] {
  std::array<uint8_t, kFar + 1> out{};
  for (int square = 0; square <= kFar; ++square)
    for (int halves = 2; halves <= static_cast<int>(kThickest); ++halves)
      if (4 * square >= (halves + 2) * (halves + 2)) out[static_cast<size_t>(square)] = static_cast<uint8_t>(halves);
  return out;
}();

// A centre near a cell: where it is from there (corners come after all cells), and the least thickness whose reach it is in.
struct Centre {
  int offset;
  uint8_t least;
};
const std::vector<Centre>& centres_near() {
  static const std::vector<Centre> out = [] {
    std::vector<std::pair<int, Centre>> all;  // by squared distance in half cells
    const auto add = [&](int square, int offset) {
      for (int halves = 2; halves <= static_cast<int>(kThickest); ++halves)
        if (16 * square <= (3 * halves + 12) * (3 * halves + 12)) {
          all.push_back({square, {offset, static_cast<uint8_t>(halves)}});
          return;
        }
    };
    for (int v = -8; v <= 8; ++v)
      for (int u = -8; u <= 8; ++u)
        for (int w = -8; w <= 8; ++w) {
          const int offset = v * kPlane + u * kRow + w;
          add(4 * (u * u + v * v + w * w), offset);
          const auto half = [](int i) { return (2 * i - 1) * (2 * i - 1); };  // corner i of cell 0 is at i - 0.5 from its centre
          add(half(u) + half(v) + half(w), offset + kBlock);
        }
    std::ranges::stable_sort(all, {}, [](const auto& one) { return one.first; });
    std::vector<Centre> sorted;
    for (const auto& [_, centre] : all) sorted.push_back(centre);
    return sorted;
  }();
  return out;
}

// The part of the block that is in use: so many positions along v, u and w, of the corners.
using Extent = std::array<int, 3>;

constexpr ptrdiff_t position(int v, int u, int w) { return ptrdiff_t{v} * kPlane + ptrdiff_t{u} * kRow + w; }

// One axis of the distance to the nearest cell outside (P. Felzenszwalb, D. Huttenlocher, 2012), of which no more than 4.5 cells matter: each value
// becomes the least of those around it and their squared distance along the axis. `corner`: from cells to the corners before and after them.
void along(size_t axis, bool corner, const Extent& size, const std::vector<uint8_t>& in, std::vector<uint8_t>& out) {
  constexpr std::array<ptrdiff_t, 3> kStep{kPlane, kRow, 1};
  for (int v = 0; v < size[0]; ++v)
    for (int u = 0; u < size[1]; ++u) {
      const ptrdiff_t first = position(v, u, 0);
      uint8_t* const to = out.data() + first;
      std::fill_n(to, size[2], kFar);
      for (int t = corner ? -5 : -4; t <= 4; ++t) {
        const int half = corner ? 2 * t + 1 : 2 * t, at = axis == 0 ? v : u;
        if (axis != 2 && (at + t < 0 || at + t >= size[axis])) continue;
        const auto square = static_cast<uint8_t>(half * half);
        const uint8_t* const from = in.data() + first + t * kStep[axis];
        const int begin = axis == 2 ? std::max(0, -t) : 0, end = size[2] - (axis == 2 ? std::max(0, t) : 0);
        for (int w = begin; w < end; ++w) to[w] = std::min(to[w], static_cast<uint8_t>(from[w] + square));
      }
    }
}

}  // namespace

const std::vector<ThinRun>& Thickness::thin_runs(const Field& field) {
  out_.clear();
  find_doubtful(field);
  const auto tile_of = [&](const Stretch& s) { return std::tuple(s.label, (s.v - field.column.v0) / kTile, (s.u - field.column.u0) / kTile); };
  std::ranges::sort(doubtful_, {}, [&](const Stretch& s) { return std::pair(tile_of(s), s.from); });
  for (size_t begin = 0, end; begin < doubtful_.size(); begin = end) {
    for (end = begin + 1; end < doubtful_.size() && tile_of(doubtful_[end]) == tile_of(doubtful_[begin]);) ++end;
    look_at(field.rays, std::span(doubtful_).subspan(begin, end - begin));
  }
  std::ranges::sort(out_, {}, [](const ThinRun& run) { return std::tuple(run.v, run.u, run.from); });
  size_t kept = 0;
  for (const ThinRun& run : out_) {
    if (kept > 0) {
      ThinRun& last = out_[kept - 1];
      if (last.to == run.from && last.u == run.u && last.v == run.v && last.label == run.label && last.halves == run.halves) {
        last.to = run.to;
        continue;
      }
    }
    out_[kept++] = run;
  }
  out_.resize(kept);
  return out_;
}

std::span<const Thickness::Core> Thickness::cores_of(const RayBlock& rays, uint32_t u, uint32_t v) {
  const uint32_t ray = v * rays.nu + u;
  if (cores_of_[ray].from == kUnknown) {
    const auto begin = static_cast<uint32_t>(cores_.size());
    uint32_t run = 0;
    rays.for_each_run(ray, [&](uint32_t from, uint32_t to, SetId label) {
      if (walls_[label]) add_core(rays, u, v, run, {from, to}, static_cast<Label>(label));
      ++run;
    });
    cores_of_[ray] = {begin, static_cast<uint32_t>(cores_.size())};
  }
  return std::span(cores_).subspan(cores_of_[ray].from, cores_of_[ray].to - cores_of_[ray].from);
}

// Keeps one interval of a run: what is lost that way is looked at cell by cell.
void Thickness::add_core(const RayBlock& rays, uint32_t u, uint32_t v, uint32_t run, Interval cells, Label label) {
  const uint32_t ray = v * rays.nu + u;
  Interval core = shrunk(cells.from, cells.to, root(kDeep2), rays.length);
  for (const Beside& b : rays_within_depth()) {
    if (core.from >= core.to) return;
    const int64_t other_u = int64_t{u} + b.u, other_v = int64_t{v} + b.v;
    if (other_u < 0 || other_v < 0 || other_u >= rays.nu || other_v >= rays.nv) continue;  // beyond the domain
    const auto other = static_cast<uint32_t>(other_v * rays.nu + other_u);
    const std::span<const uint32_t> changes = rays.changes(other);
    const auto ends = [&](size_t i) {
      return shrunk(i == 0 ? 0 : changes[i - 1], i < changes.size() ? changes[i] : rays.length, b.reach, rays.length);
    };
    Interval best{0, 0};
    if (rays.pattern[other] == rays.pattern[ray]) {
      const Interval there = ends(run);
      best = {std::max(core.from, there.from), std::min(core.to, there.to)};
    } else {
      const std::span<const SetId> labels = rays.sets(other);
      for (size_t i = run_at(changes, core.from); i < labels.size() && (i == 0 || changes[i - 1] < core.to); ++i) {
        if (labels[i] != label) continue;
        const Interval there = ends(i), both{std::max(core.from, there.from), std::min(core.to, there.to)};
        if (both.from < both.to && both.to - both.from > best.to - best.from) best = both;
      }
    }
    core = best;
  }
  if (core.from < core.to) cores_.push_back({core.from, core.to, label});
}

// What no core near it proves.
void Thickness::find_doubtful(const Field& field) {
  const RayBlock& rays = field.rays;
  doubtful_.clear(), cores_.clear();
  cores_of_.assign(size_t{rays.nu} * rays.nv, {kUnknown, kUnknown});
  for (uint32_t v = field.column.v0; v < field.column.v1; ++v)
    for (uint32_t u = field.column.u0; u < field.column.u1; ++u)
      rays.for_each_run(v * rays.nu + u, [&](uint32_t from, uint32_t to, SetId label) {
        if (!walls_[label]) return;
        left_.assign(1, {from, to});
        for (const std::vector<Beside>& near : rays_near(u, v))
          for (const Beside& b : near) {
            const int64_t other_u = int64_t{u} + b.u, other_v = int64_t{v} + b.v;
            if (other_u < 0 || other_v < 0 || other_u >= rays.nu || other_v >= rays.nv) continue;
            take_proven(cores_of(rays, static_cast<uint32_t>(other_u), static_cast<uint32_t>(other_v)), static_cast<Label>(label),
                        static_cast<uint32_t>(b.reach));
            if (left_.empty()) return;
          }
        for (const Interval& one : left_) doubtful_.push_back({u, v, one.from, one.to, static_cast<Label>(label)});
      });
}

// Takes what lies within `reach` cells of the cores out of what is left of a run. The cores of a ray ascend and don't overlap, so those that come
// before what is left are skipped by bisection: a ray may have very many runs.
void Thickness::take_proven(std::span<const Core> cores, Label label, uint32_t reach) {
  if (cores.empty() || cores.back().to + reach <= left_.front().from || cores.front().from >= left_.back().to + reach) return;
  auto core = std::ranges::partition_point(cores, [&](const Core& c) { return c.to + reach <= left_.front().from; });
  if (core->from >= left_.back().to + reach) return;
  next_.clear();
  for (Interval one : left_) {
    for (; core != cores.end() && core->from < one.to + reach; ++core) {
      if (core->label != label) continue;
      const uint32_t from = core->from - std::min(core->from, reach);
      if (one.from < from) next_.push_back({one.from, from});
      one.from = std::max(one.from, core->to + reach);
      if (one.from >= one.to) break;  // it may reach into the next one, too
    }
    if (one.from < one.to) next_.push_back(one);
  }
  std::swap(left_, next_);
}

// Stretches of one label, by where they begin. They are measured some cells at a time; where nothing changes near them, all cells along the rays are
// like the first.
void Thickness::look_at(const RayBlock& rays, std::span<Stretch> tile) {
  constexpr auto kNear = static_cast<uint32_t>(kMargin);
  find_changes(rays, tile);
  block_.clear();
  uint32_t at = 0;  // all before are done
  for (size_t next = 0; next < tile.size() || !block_.empty();) {
    if (block_.empty()) at = tile[next].from;
    Interval valid{at, at + kSlab};
    bool alike = false;
    const auto change = std::ranges::lower_bound(changes_, at - std::min(at, kNear - 1));  // the one that comes next, unless it is near already
    if (change != changes_.end() && *change > at + kNear + kSlab) alike = true, valid.to = *change - kNear;
    for (; next < tile.size() && tile[next].from < valid.to; ++next) block_.push_back(tile[next]);
    valid.to = std::min(valid.to, std::ranges::max(block_, {}, &Stretch::to).to);
    measure(rays, block_, {at, alike ? at + 1 : valid.to}, valid);
    at = valid.to;
    std::erase_if(block_, [&](const Stretch& s) { return s.to <= at; });
  }
}

// All changes near the stretches, where some of these are long.
void Thickness::find_changes(const RayBlock& rays, std::span<const Stretch> tile) {
  changes_.clear();
  uint32_t u0 = ~0u, u1 = 0, v0 = ~0u, v1 = 0, longest = 0;
  for (const Stretch& s : tile) {
    u0 = std::min(u0, s.u), u1 = std::max(u1, s.u + 1), v0 = std::min(v0, s.v), v1 = std::max(v1, s.v + 1);
    longest = std::max(longest, s.to - s.from);
  }
  if (longest <= kSlab) return;
  constexpr auto kNear = static_cast<uint32_t>(kMargin);
  changes_ = {0, rays.length};
  for (uint32_t v = v0 - std::min(v0, kNear); v < std::min(v1 + kNear, rays.nv); ++v)
    for (uint32_t u = u0 - std::min(u0, kNear); u < std::min(u1 + kNear, rays.nu); ++u) {
      const std::span<const uint32_t> changes = rays.changes(v * rays.nu + u);
      changes_.insert(changes_.end(), changes.begin(), changes.end());
    }
  std::ranges::sort(changes_);
}

// Measures the cells of the stretches in [cells.from, cells.to) along the rays, of which the first one stands for all in `valid` where these are
// more.
void Thickness::measure(const RayBlock& rays, std::span<const Stretch> block, Interval cells, Interval valid) {
  const Label label = block.front().label;
  const auto [first_u, last_u] = std::ranges::minmax(block | std::views::transform(&Stretch::u));
  const auto [first_v, last_v] = std::ranges::minmax(block | std::views::transform(&Stretch::v));
  const std::array<int64_t, 3> origin = {int64_t{first_v} - kMargin, int64_t{first_u} - kMargin, int64_t{cells.from} - kMargin};
  const std::array<int64_t, 3> size = {rays.nv, rays.nu, rays.length};
  const Extent extent = {static_cast<int>(last_v - first_v) + 1 + 2 * kMargin + 1, static_cast<int>(last_u - first_u) + 1 + 2 * kMargin + 1,
                         static_cast<int>(cells.to - cells.from) + 2 * kMargin + 1};
  // The positions of an axis that are in the grid, and at least so far from the block's ends: of cells, and of corners, which are one more.
  const auto inside = [&](size_t d, int more, int within) {
    return std::pair(static_cast<int>(std::clamp<int64_t>(-origin[d], within, extent[d])),
                     static_cast<int>(std::clamp<int64_t>(size[d] + more - origin[d], 0, extent[d] - within)));
  };
  const auto at = [](int pv, int pu, int pw) { return static_cast<size_t>(position(pv, pu, pw)); };
  const auto fill = [&](std::vector<uint8_t>& values, size_t first, uint8_t value) {
    for (int pv = 0; pv < extent[0]; ++pv)
      for (int pu = 0; pu < extent[1]; ++pu) std::fill_n(values.begin() + static_cast<ptrdiff_t>(first + at(pv, pu, 0)), extent[2], value);
  };
  one_.resize(kBlock), turned_.resize(kBlock), other_.resize(kBlock), centres_.resize(size_t{2} * kBlock);
  fill(one_, 0, kFar), fill(centres_, 0, 0), fill(centres_, kBlock, 0);
  const auto [v0, v1] = inside(0, 0, 0);
  const auto [u0, u1] = inside(1, 0, 0);
  const auto [w0, w1] = inside(2, 0, 0);
  for (int pv = v0; pv < v1; ++pv)
    for (int pu = u0; pu < u1; ++pu)
      rays.for_each_run(static_cast<uint32_t>((origin[0] + pv) * rays.nu + origin[1] + pu), static_cast<uint32_t>(origin[2] + w0),
                        static_cast<uint32_t>(origin[2] + w1), [&](uint32_t from, uint32_t to, SetId set) {
                          if (set != label)
                            std::fill_n(one_.begin() + static_cast<ptrdiff_t>(at(pv, pu, static_cast<int>(from - origin[2]))), to - from, 0);
                        });

  uint8_t most = 0;
  for (const bool corner : {false, true}) {
    along(2, corner, extent, one_, turned_);
    along(1, corner, extent, turned_, other_);
    along(0, corner, extent, other_, turned_);
    const auto [begin_v, end_v] = inside(0, corner, kBeyond);
    const auto [begin_u, end_u] = inside(1, corner, kBeyond);
    const auto [begin_w, end_w] = inside(2, corner, kBeyond);
    for (int pv = begin_v; pv < end_v; ++pv)
      for (int pu = begin_u; pu < end_u; ++pu)
        for (int pw = begin_w; pw < end_w; ++pw) {
          const uint8_t allowed = kAllowed[turned_[at(pv, pu, pw)]];
          centres_[at(pv, pu, pw) + (corner ? kBlock : 0)] = allowed;
          most = std::max(most, allowed);
        }
  }

  const auto measured = [&](const Stretch& s, uint32_t w) {
    const uint8_t* const cell = &centres_[at(static_cast<int>(s.v - origin[0]), static_cast<int>(s.u - origin[1]), static_cast<int>(w - origin[2]))];
    uint8_t out = 0;
    for (const Centre& centre : centres_near()) {
      if (centre.least > most) break;
      const uint8_t allowed = cell[centre.offset];
      if (allowed < centre.least || allowed <= out) continue;
      out = allowed;
      if (out == most) break;
    }
    return uint32_t{out};
  };
  const bool alike = valid.to > cells.to;
  for (const Stretch& s : block) {
    const uint32_t from = std::max(s.from, valid.from), to = std::min(s.to, valid.to);
    for (uint32_t w = from; w < to;) {
      const uint32_t end = alike ? to : w + 1, halves = measured(s, alike ? cells.from : w);
      if (halves < kThickest) out_.push_back({s.u, s.v, w, end, label, halves});
      w = end;
    }
  }
}

}  // namespace teracell::store
