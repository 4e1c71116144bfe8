#include "store/check/thickness.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace teracell::inline store {
namespace {

constexpr int kDeep2 = 20;   // cells up to this squared distance are inside where a centre is 4.5 cells deep
constexpr int kReach2 = 56;  // cells up to this squared distance are within 7.5 cells
constexpr int kLattice = 3;
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

// The rays of the lattice near a ray that is (du, dv) beyond one of them: by steps of the lattice, the nearest first.
const std::vector<Beside>& lattice_near(uint32_t du, uint32_t dv) {
  static const std::array<std::vector<Beside>, kLattice * kLattice> out = [] {
    std::array<std::vector<Beside>, kLattice * kLattice> all;
    for (int i = 0; i < kLattice * kLattice; ++i) {
      const auto square = [&](const Beside& b) {
        const int u = kLattice * b.u - i % kLattice, v = kLattice * b.v - i / kLattice;
        return u * u + v * v;
      };
      for (int v = -2; v <= 3; ++v)
        for (int u = -2; u <= 3; ++u)
          if (Beside b{u, v, 0}; square(b) <= kReach2) {
            b.reach = root(kReach2 - square(b));
            all[i].push_back(b);
          }
      std::ranges::stable_sort(all[i], {}, square);
    }
    return all;
  }();
  return out[dv * kLattice + du];
}

// A run, less `reach` cells at its ends. The domain's sides are no ends.
struct Ends {
  uint32_t from, to;
};
Ends shrunk(uint32_t from, uint32_t to, int reach, uint32_t length) {
  const auto by = static_cast<uint32_t>(reach);
  return {from == 0 ? 0 : from + by, to == length ? to : to - std::min(to, by)};
}

// A block of cells, with a margin on each side: at most kTile rays along u and v, and kSlab cells.
constexpr int kTile = 32, kSlab = 32;
constexpr int kSide = kTile + 2 * kMargin;        // of the cells; corners are one more
constexpr int kRow = kSide + 1, kPlane = kRow * kRow, kBlock = kRow * kRow * kRow;
static_assert(kTile == kSlab);
// Of the centres that are near a cell of the block, by their positions: the first, and the one after the last.
constexpr int kNearest = kMargin - 7, kFarthest = kMargin + kTile + 8;
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

// One axis of the distance to the nearest cell outside (P. Felzenszwalb, D. Huttenlocher, 2012), of which no more than 4.5 cells matter: each value
// becomes the least of those around it and their squared distance along the axis. `corner`: from cells to the corners before and after them.
void along(int step, bool corner, const std::vector<uint8_t>& in, std::vector<uint8_t>& out) {
  out.assign(in.size(), kFar);
  for (int t = corner ? -5 : -4; t <= 4; ++t) {
    const int half = corner ? 2 * t + 1 : 2 * t;
    const auto square = static_cast<uint8_t>(half * half);
    const int shift = t * step, begin = std::max(0, -shift), end = kBlock - std::max(0, shift);
    for (int i = begin; i < end; ++i) {
      const auto value = static_cast<uint8_t>(in[static_cast<size_t>(i + shift)] + square);
      if (value < out[static_cast<size_t>(i)]) out[static_cast<size_t>(i)] = value;
    }
  }
}

}  // namespace

const std::vector<ThinRun>& Thickness::thin_runs(const Field& field) {
  out_.clear();
  find_cores(field);
  find_doubtful(field);
  const auto tile_of = [&](const Stretch& s) {
    return std::tuple(s.label, (s.v - field.column.v0) / kTile, (s.u - field.column.u0) / kTile);
  };
  std::ranges::stable_sort(doubtful_, {}, tile_of);
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

void Thickness::find_cores(const Field& field) {
  const RayBlock& rays = field.rays;
  const auto first = [](uint32_t from, uint32_t to) { return std::min(from - std::min(from, 7u) + 1, to - 1); };
  lattice_u_ = first(field.column.u0, rays.nu), lattice_v_ = first(field.column.v0, rays.nv);
  const auto count = [](uint32_t begin, uint32_t end) { return (end - 1 - begin) / kLattice + 1; };
  lattice_nu_ = count(lattice_u_, std::min(field.column.u1 + 7, rays.nu));
  lattice_nv_ = count(lattice_v_, std::min(field.column.v1 + 7, rays.nv));
  cores_.clear(), core_begin_.assign(1, 0);
  for (uint32_t j = 0; j < lattice_nv_; ++j)
    for (uint32_t i = 0; i < lattice_nu_; ++i) {
      const uint32_t u = lattice_u_ + kLattice * i, v = lattice_v_ + kLattice * j;
      uint32_t run = 0;
      rays.for_each_run(v * rays.nu + u, [&](uint32_t from, uint32_t to, SetId label) {
        if (walls_[label]) add_core(rays, u, v, run, {from, to}, static_cast<Label>(label));
        ++run;
      });
      core_begin_.push_back(static_cast<uint32_t>(cores_.size()));
    }
}

// Keeps one interval of a run: what is lost that way is looked at cell by cell.
void Thickness::add_core(const RayBlock& rays, uint32_t u, uint32_t v, uint32_t run, Interval cells, Label label) {
  const uint32_t ray = v * rays.nu + u;
  Ends core = shrunk(cells.from, cells.to, root(kDeep2), rays.length);
  for (const Beside& b : rays_within_depth()) {
    if (core.from >= core.to) return;
    const int64_t other_u = int64_t{u} + b.u, other_v = int64_t{v} + b.v;
    if (other_u < 0 || other_v < 0 || other_u >= rays.nu || other_v >= rays.nv) continue;  // beyond the domain
    const auto other = static_cast<uint32_t>(other_v * rays.nu + other_u);
    const std::span<const uint32_t> changes = rays.changes(other);
    const auto ends = [&](size_t i) { return shrunk(i == 0 ? 0 : changes[i - 1], i < changes.size() ? changes[i] : rays.length, b.reach, rays.length); };
    Ends best{0, 0};
    if (rays.pattern[other] == rays.pattern[ray]) {
      const Ends there = ends(run);
      best = {std::max(core.from, there.from), std::min(core.to, there.to)};
    } else {
      const std::span<const SetId> labels = rays.sets(other);
      for (size_t i = run_at(changes, core.from); i < labels.size() && (i == 0 || changes[i - 1] < core.to); ++i) {
        if (labels[i] != label) continue;
        const Ends there = ends(i), both{std::max(core.from, there.from), std::min(core.to, there.to)};
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
  doubtful_.clear();
  const auto beyond = [](uint32_t at, uint32_t lattice) { return static_cast<uint32_t>((int64_t{at} - lattice + kLattice) % kLattice); };
  for (uint32_t v = field.column.v0; v < field.column.v1; ++v)
    for (uint32_t u = field.column.u0; u < field.column.u1; ++u) {
      const uint32_t du = beyond(u, lattice_u_), dv = beyond(v, lattice_v_);
      const int64_t i0 = (int64_t{u} - du - lattice_u_) / kLattice, j0 = (int64_t{v} - dv - lattice_v_) / kLattice;
      rays.for_each_run(v * rays.nu + u, [&](uint32_t from, uint32_t to, SetId label) {
        if (!walls_[label]) return;
        left_.assign(1, {from, to});
        for (const Beside& b : lattice_near(du, dv)) {
          const int64_t i = i0 + b.u, j = j0 + b.v;
          if (i < 0 || j < 0 || i >= lattice_nu_ || j >= lattice_nv_) continue;
          const auto at = static_cast<size_t>(j * lattice_nu_ + i);
          for (uint32_t c = core_begin_[at]; c < core_begin_[at + 1]; ++c) {
            if (cores_[c].label != label) continue;
            const auto reach = static_cast<uint32_t>(b.reach);
            const uint32_t proven_from = cores_[c].from - std::min(cores_[c].from, reach), proven_to = cores_[c].to + reach;
            next_.clear();
            for (const Interval& one : left_) {
              if (one.from < proven_from) next_.push_back({one.from, std::min(one.to, proven_from)});
              if (one.to > proven_to) next_.push_back({std::max(one.from, proven_to), one.to});
            }
            std::swap(left_, next_);
          }
          if (left_.empty()) return;
        }
        for (const Interval& one : left_) doubtful_.push_back({u, v, one.from, one.to, static_cast<Label>(label)});
      });
    }
}

// Cells along the rays are alike where nothing changes near them; elsewhere they are measured some at a time.
void Thickness::look_at(const RayBlock& rays, std::span<const Stretch> tile) {
  uint32_t u0 = ~0u, u1 = 0, v0 = ~0u, v1 = 0;
  left_.clear();
  for (const Stretch& s : tile) {
    u0 = std::min(u0, s.u), u1 = std::max(u1, s.u + 1), v0 = std::min(v0, s.v), v1 = std::max(v1, s.v + 1);
    left_.push_back({s.from, s.to});
  }
  changes_ = {0, rays.length};
  constexpr auto kNear = static_cast<uint32_t>(kMargin);
  for (uint32_t v = v0 - std::min(v0, kNear); v < std::min(v1 + kNear, rays.nv); ++v)
    for (uint32_t u = u0 - std::min(u0, kNear); u < std::min(u1 + kNear, rays.nu); ++u) {
      const std::span<const uint32_t> changes = rays.changes(v * rays.nu + u);
      changes_.insert(changes_.end(), changes.begin(), changes.end());
    }
  std::ranges::sort(changes_);
  std::ranges::sort(left_, {}, &Interval::from);
  uint32_t at = 0;  // all before are done
  for (const Interval& one : left_) {
    at = std::max(at, one.from);
    while (at < one.to) {
      // The change that comes next, unless it is near already.
      const auto next = std::ranges::lower_bound(changes_, at - std::min(at, kNear - 1));
      uint32_t to = std::min(at + kSlab, one.to);
      Interval valid{at, to};
      if (next != changes_.end() && *next > at + kNear) {
        valid = {at, std::max(at + 1, std::min(one.to, *next - kNear))};
        to = at + 1;
      }
      measure(rays, tile, u0, v0, {at, to}, valid);
      at = valid.to;
    }
  }
}

// Measures the cells of the tile in [cells.from, cells.to) along the rays, of which the first one stands for all in `valid` where these are more.
// (u, v): the tile's first ray.
void Thickness::measure(const RayBlock& rays, std::span<const Stretch> tile, uint32_t u, uint32_t v, Interval cells, Interval valid) {
  const Label label = tile.front().label;
  const std::array<int64_t, 3> origin = {int64_t{v} - kMargin, int64_t{u} - kMargin, int64_t{cells.from} - kMargin};
  const std::array<int64_t, 3> size = {rays.nv, rays.nu, rays.length};
  // The positions of an axis that are in the grid: of cells, and of corners, which are one more.
  const auto inside = [&](size_t d, int more) {
    return std::pair(static_cast<int>(std::clamp<int64_t>(-origin[d], 0, kRow)), static_cast<int>(std::clamp<int64_t>(size[d] + more - origin[d], 0, kRow)));
  };
  const auto [v0, v1] = inside(0, 0);
  const auto [u0, u1] = inside(1, 0);
  const auto [w0, w1] = inside(2, 0);
  const auto at = [](int pv, int pu, int pw) { return static_cast<size_t>(pv * kPlane + pu * kRow + pw); };
  one_.assign(kBlock, kFar);
  for (int pv = v0; pv < v1; ++pv)
    for (int pu = u0; pu < u1; ++pu)
      rays.for_each_run(static_cast<uint32_t>((origin[0] + pv) * rays.nu + origin[1] + pu), static_cast<uint32_t>(origin[2] + w0),
                        static_cast<uint32_t>(origin[2] + w1), [&](uint32_t from, uint32_t to, SetId set) {
                          if (set != label) std::fill_n(one_.begin() + static_cast<ptrdiff_t>(at(pv, pu, static_cast<int>(from - origin[2]))), to - from, 0);
                        });

  centres_.assign(2 * kBlock, 0);
  uint8_t most = 0;
  for (const bool corner : {false, true}) {
    along(1, corner, one_, turned_);
    along(kRow, corner, turned_, other_);
    along(kPlane, corner, other_, turned_);
    const auto [begin_v, end_v] = inside(0, corner);
    const auto [begin_u, end_u] = inside(1, corner);
    const auto [begin_w, end_w] = inside(2, corner);
    for (int pv = std::max(begin_v, kNearest); pv < std::min(end_v, kFarthest); ++pv)
      for (int pu = std::max(begin_u, kNearest); pu < std::min(end_u, kFarthest); ++pu)
        for (int pw = std::max(begin_w, kNearest); pw < std::min(end_w, kFarthest); ++pw) {
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
  for (const Stretch& s : tile) {
    const uint32_t from = std::max(s.from, valid.from), to = std::min(s.to, valid.to);
    for (uint32_t w = from; w < to;) {
      const uint32_t end = alike ? to : w + 1, halves = measured(s, alike ? cells.from : w);
      if (halves < kThickest) out_.push_back({s.u, s.v, w, end, label, halves});
      w = end;
    }
  }
}

}  // namespace teracell::store
