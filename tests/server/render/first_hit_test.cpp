// The first cell on a line of sight, against a search through all cells.
#include "server/render/first_hit.hpp"

#include "server/render/prepared.hpp"
#include "store/read/kept_chunks.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Span {
  double enter, leave;
};

// The part of the line that lies in a box of planes, half open along each axis.
Span within(const Grid& grid, const Sight& sight, const Index3& lo, const Index3& hi) {
  Span out{0, kInfinity};
  for (int d = 0; d < 3; ++d) {
    const double from = sight.from[d], along = sight.along[d];
    const double below = grid.axis[d].plane(lo[d]), above = grid.axis[d].plane(hi[d]);
    if (along == 0) {
      const bool last = from == grid.axis[d].max() && hi[d] == grid.axis[d].cells();
      if (!(below <= from && (from < above || last))) return {1, 0};
      continue;
    }
    double enter = (below - from) * (1 / along), leave = (above - from) * (1 / along);
    if (along < 0) std::swap(enter, leave);
    out.enter = std::max(out.enter, enter), out.leave = std::min(out.leave, leave);
  }
  return out;
}

// The part of the line that is cut away.
Span cut_away(const Sight& sight, const Cut& cut) {
  Span out{-kInfinity, kInfinity};
  for (const HalfSpace& half : cut) {
    const double along = dot(half.normal, sight.along), off = half.offset - dot(half.normal, sight.from);
    if (along == 0 && off > 0) return {1, 0};
    if (along > 0) out.enter = std::max(out.enter, off * (1 / along));
    if (along < 0) out.leave = std::min(out.leave, off * (1 / along));
  }
  return out;
}

// When the line first is in what is left of the span; infinite when nothing is left.
double first_left(const Sight& sight, Span span, const Cuts& cuts) {
  for (bool moved = true; moved;) {
    moved = false;
    for (const Cut& cut : cuts)
      if (const Span gone = cut_away(sight, cut); gone.enter < gone.leave && gone.enter <= span.enter && span.enter < gone.leave)
        span.enter = gone.leave, moved = true;
  }
  return span.enter < span.leave ? span.enter : kInfinity;
}

// Whether nothing is cut away between two times.
bool is_whole(const Sight& sight, double from, double to, const Cuts& cuts) {
  for (const Cut& cut : cuts)
    if (const Span gone = cut_away(sight, cut); gone.enter < gone.leave && from < gone.leave && gone.enter < to) return false;
  return true;
}

// The visible cell of a level that the line enters first, as the time when it does; infinite when there is none.
template <class IsVisible>
std::pair<double, Index3> first_by_search(const Grid& grid, int level, const Sight& sight, const Cuts& cuts, IsVisible is_visible) {
  std::pair<double, Index3> best{kInfinity, {}};
  const Index3 n = grid.cells(level), all = grid.cells();
  Index3 c;
  for (c[2] = 0; c[2] < n[2]; ++c[2])
    for (c[1] = 0; c[1] < n[1]; ++c[1])
      for (c[0] = 0; c[0] < n[0]; ++c[0]) {
        if (!is_visible(c)) continue;
        Index3 lo, hi;
        for (int d = 0; d < 3; ++d) lo[d] = c[d] << level, hi[d] = std::min((c[d] + 1) << level, all[d]);
        if (const double t = first_left(sight, within(grid, sight, lo, hi), cuts); t < best.first) best = {t, c};
      }
  return best;
}

// Half-spaces along an axis, corners and oblique planes, some of them through planes of cells.
Cuts random_cuts(std::mt19937_64& random, const Grid& grid) {
  Cuts out(random() % 3);
  for (Cut& cut : out) {
    Vec3 at;
    for (int d = 0; d < 3; ++d) {
      const Axis& axis = grid.axis[d];
      std::uniform_real_distribution<double> inside(axis.min(), axis.max());
      at[d] = random() % 2 ? axis.plane(axis.cells() / 2) : inside(random);
    }
    const int kind = static_cast<int>(random() % 3);
    std::uniform_real_distribution<double> component(-1, 1);
    if (kind == 2) {
      const Vec3 normal = {component(random), component(random), component(random)};
      cut = {{normal, dot(normal, at)}};
    } else
      for (int d = 0; d < 3; ++d) {
        Vec3 normal{};
        normal[d] = random() % 2 ? 1 : -1;
        if (kind == 1 || d == static_cast<int>(random() % 3)) cut.push_back({normal, normal[d] * at[d]});
      }
    if (cut.empty()) cut = {{{1, 0, 0}, at[0]}};
  }
  return out;
}

Axis random_axis(std::mt19937_64& random, int64_t n) {
  std::uniform_real_distribution<double> length(0.1, 3);
  if (random() % 3 != 0) return Axis::uniform(static_cast<double>(random() % 7) - 3, random() % 2 ? 1 : length(random), 0, n, 0.5);
  std::vector<double> planes = {static_cast<double>(random() % 5)};
  for (int64_t i = 0; i < n; ++i) planes.push_back(planes.back() + length(random) * (random() % 5 == 0 ? 30 : 1));
  return Axis::graded(planes, 0.5);
}

// Lines through random points; along axes, through planes and corners; from inside, from outside, and past the grid.
Sight random_sight(std::mt19937_64& random, const Grid& grid) {
  Vec3 from, at;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = grid.axis[d];
    const double length = axis.max() - axis.min();
    std::uniform_real_distribution<double> around(axis.min() - length, axis.max() + length), inside(axis.min(), axis.max());
    const double plane = axis.plane(static_cast<int64_t>(random() % static_cast<uint64_t>(axis.cells() + 1)));
    from[d] = random() % 4 == 0 ? plane : around(random);
    at[d] = random() % 4 == 0 ? plane : inside(random);
  }
  Vec3 along = at - from;
  for (int d = 0; d < 3; ++d)
    if (random() % 4 == 0) along[d] = 0, from[d] = at[d];
  if (along == Vec3{}) along[random() % 3] = random() % 2 ? 1 : -1;
  return {from, along};
}

struct Scene {
  Grid grid;
  std::vector<Label> cells;
  Label at(const Index3& c) const {
    const Index3 n = grid.cells();
    return cells[static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0])];
  }
};

TEST_CASE("the first visible cell of a line of sight is that of a search through all cells, whatever axis, chunks, level and cut", "[render]") {
  std::mt19937_64 random(1901);
  const TempFolder folder;
  constexpr uint32_t kLabels = 4;
  int found = 0;
  for (int round = 0; round < 24; ++round) {
    CAPTURE(round);
    const auto side = [&] { return static_cast<int64_t>(1 + random() % 14); };
    const Index3 n = {side(), side(), round % 5 == 0 ? 1 : side()};
    const Scene scene{{{random_axis(random, n[0]), random_axis(random, n[1]), random_axis(random, n[2])}}, random_cells(random, n, kLabels)};
    Metadata meta = metadata_of(scene.grid, round % 3, kLabels);
    if (round % 2) meta = with_tiny_chunks(meta);
    const auto file = folder / std::to_string(round);
    store_cells(file, meta, scene.cells);
    const GridReader reader(std::make_unique<InputFile>(file), std::make_shared<KeptChunks>(1 << 16));
    std::vector<bool> shown(kLabels);
    for (Label l = 1; l < kLabels; ++l) shown[l] = random() % 4 != 0;
    if (round % 6 == 0) shown[0] = true;
    const Visible visible(shown);
    const int level = static_cast<int>(random() % 3) % reader.levels();
    const Occupancy occupancy(reader, visible, level, 1 + round % 3);
    const Cuts cuts = random_cuts(random, scene.grid);
    const Subject subject{reader, visible, occupancy, cuts, level};
    const Camera camera{};
    FirstHits hits(subject, camera);
    const std::vector<Mask> sets = level_by_hand(scene.grid, scene.cells, level);
    const Index3 coarse = scene.grid.cells(level);
    const auto set_of = [&](const Index3& c) {
      Mask set = sets[static_cast<size_t>((c[2] * coarse[1] + c[1]) * coarse[0] + c[0])];
      for (Label l = 0; l < kLabels; ++l)
        if (!shown[l]) set &= ~(Mask{1} << l);
      return set;
    };
    for (int i = 0; i < 300; ++i) {
      const Sight sight = random_sight(random, scene.grid);
      CAPTURE(i, level, sight.from[0], sight.from[1], sight.from[2], sight.along[0], sight.along[1], sight.along[2]);
      const auto [t, cell] = first_by_search(scene.grid, level, sight, cuts, [&](const Index3& c) { return set_of(c) != 0; });
      const auto hit = hits.first(sight);
      REQUIRE(hit.has_value() == std::isfinite(t));
      if (!hit) continue;
      ++found;
      // What is seen of a coarse cell is the first of its own cells; where the line meets none of them, before it is cut, the strongest of its
      // labels.
      const Mask set = set_of(cell);
      const auto [fine_t, fine] = first_by_search(scene.grid, 0, sight, cuts, [&, coarse = cell](const Index3& c) {
        for (int d = 0; d < 3; ++d)
          if (c[d] >> level != coarse[d]) return false;
        return static_cast<bool>(shown[scene.at(c)]);
      });
      const bool several = (set & (set - 1)) != 0, meets = std::isfinite(fine_t) && is_whole(sight, t, fine_t, cuts);
      REQUIRE(hit->t == (several && meets ? fine_t : t));
      REQUIRE(hit->level == (several && meets ? 0 : level));
      REQUIRE(hit->cell == (several && meets ? fine : cell));
      Label strongest = 0;
      for (Label l = 0; l < kLabels; ++l)
        if (set >> l & 1) strongest = l;  // metadata_of(): the last is the strongest
      REQUIRE(hit->label == (several && meets ? scene.at(fine) : strongest));
    }
  }
  CHECK(found > 1000);
}

TEST_CASE("the first cell that differs is that of a search through all cells, whatever axes, chunks, level, cells and units of the second grid",
          "[render]") {
  std::mt19937_64 random(1902);
  constexpr uint32_t kLabels = 4;
  std::array<int, 3> found{};
  for (int round = 0; round < 24; ++round) {
    CAPTURE(round);
    const auto side = [&] { return static_cast<int64_t>(1 + random() % 14); };
    const bool equal = round % 2 == 0;
    const Index3 n = {side(), side(), side()};
    const Grid grid = {{random_axis(random, n[0]), random_axis(random, n[1]), random_axis(random, n[2])}};
    const Scene scene{grid, random_cells(random, n, kLabels)};
    Scene other = scene;
    if (equal) {
      for (Label& cell : other.cells)
        if (random() % 4 == 0) cell = static_cast<Label>(random() % kLabels);
    } else {  // it reaches less far on one side, and farther on the other one, in tenths of the unit
      const Index3 m = {side(), side(), side()};
      for (int d = 0; d < 3; ++d) {
        const double lo = grid.axis[d].min(), length = grid.axis[d].max() - lo;
        other.grid.axis[d] = Axis::uniform(10 * (lo + 0.1 * length), 10 * length / static_cast<double>(m[d]), 0, m[d], 0.5);
      }
      other.cells = random_cells(random, m, kLabels);
    }
    Metadata a = metadata_of(scene.grid, round % 3, kLabels), b = metadata_of(other.grid, static_cast<int>(random() % 3), kLabels);
    a.units = "cm", b.units = equal ? "cm" : "mm";
    std::swap(b.materials[2].name, b.materials[3].name);  // materials are known by their names
    if (round % 4 < 2) b = with_tiny_chunks(b);
    const GridReader left = reader_of(a, scene.cells), right = reader_of(b, other.cells);
    const auto names_there = [&](const Index3& c) {
      if (equal) return std::set{b.materials[other.at(c)].name};
      std::set<std::string> out;
      Index3 at;
      const Index3 m = other.grid.cells();
      for (at[2] = 0; at[2] < m[2]; ++at[2])
        for (at[1] = 0; at[1] < m[1]; ++at[1])
          for (at[0] = 0; at[0] < m[0]; ++at[0]) {
            bool meets = true;
            for (int d = 0; d < 3; ++d) {
              const Axis &p = grid.axis[d], &q = other.grid.axis[d];
              const double lo = 10 * p.plane(c[d]), hi = 10 * p.plane(c[d] + 1), slack = 1e-9 * (hi - lo);
              meets = meets && q.plane(at[d]) < hi - slack && q.plane(at[d] + 1) > lo + slack;
            }
            if (meets) out.insert(b.materials[other.at(at)].name);
          }
      return out;
    };
    std::vector<std::optional<Label>> kinds;  // by cell, x fastest; none: it does not differ
    Index3 c;
    for (c[2] = 0; c[2] < n[2]; ++c[2])
      for (c[1] = 0; c[1] < n[1]; ++c[1])
        for (c[0] = 0; c[0] < n[0]; ++c[0]) {
          const std::string &air = a.materials[0].name, here = a.materials[scene.at(c)].name;
          const std::set<std::string> there = names_there(c);
          if (there.empty() || there.contains(here)) kinds.emplace_back();
          else kinds.emplace_back(here == air ? kCellAdded : there == std::set{air} ? kCellRemoved : kCellOther);
        }
    const auto kind_of = [&](const Index3& cell) { return kinds[static_cast<size_t>((cell[2] * n[1] + cell[1]) * n[0] + cell[0])]; };
    const Prepared prepared(left, right, static_cast<int>(random() % 2) % left.levels(), false);
    const Cuts cuts = random_cuts(random, scene.grid);
    const Subject subject{{left, &right}, prepared.visible, prepared.occupancy, cuts, 0};
    const Camera camera{};
    FirstHits hits(subject, camera);
    for (int i = 0; i < 150; ++i) {
      const Sight sight = random_sight(random, scene.grid);
      CAPTURE(i, sight.from[0], sight.from[1], sight.from[2], sight.along[0], sight.along[1], sight.along[2]);
      const auto [t, cell] = first_by_search(scene.grid, 0, sight, cuts, [&](const Index3& at) { return kind_of(at).has_value(); });
      const auto hit = hits.first(sight);
      REQUIRE(hit.has_value() == std::isfinite(t));
      if (!hit) continue;
      REQUIRE(hit->t == t);
      REQUIRE(hit->cell == cell);
      REQUIRE(hit->label == kind_of(cell));
      ++found[hit->label];
    }
  }
  for (const int some : found) CHECK(some > 100);
}

TEST_CASE("cells that take at most a quarter of a pixel are drawn unless a level is asked for", "[render]") {
  // A plate one cell thick, half of which lies in each coarse cell: the coarser the cell, the earlier it is met.
  const Grid grid = cube_grid_of(0, 1, 64);
  std::vector<Label> cells(64 * 64 * 64);
  for (size_t i = 0; i < 64 * 64; ++i) cells[47 * 64 * 64 + i] = 1;
  const GridReader reader = reader_of(metadata_of(grid, 2, 2), cells);
  const Visible visible({false, true});
  const Occupancy occupancy(reader, visible, 0, 1);
  const Subject subject{reader, visible, occupancy, {}, std::nullopt};
  for (const auto& [pixel, plane] : {std::pair{0.1, 47}, {7.9, 47}, {8.0, 46}, {16.0, 44}, {64.0, 32}}) {
    CAPTURE(pixel);
    Camera camera{.perspective = false};
    camera.pixel = pixel;
    FirstHits hits(subject, camera);
    const auto hit = hits.first({{20.5, 20.5, -10}, {0, 0, 1}});
    REQUIRE(hit);
    CHECK(hit->t == 10 + plane);
    CHECK(hit->face == 2);
  }
}

}  // namespace
}  // namespace teracell::server
