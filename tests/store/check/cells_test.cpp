// What is found in the cells, against a search cell by cell.
#include "store/check/cells.hpp"

#include "store/read/kept_chunks.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell {
namespace {

using namespace testing;

struct Cells {
  Index3 n;
  std::vector<Label> labels;
  Label at(const Index3& c) const { return labels[static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0])]; }
  bool has(const Index3& c) const {
    for (size_t d = 0; d < 3; ++d)
      if (c[d] < 0 || c[d] >= n[d]) return false;
    return true;
  }
  template <class F>
  void each(F&& f) const {
    Index3 c;
    for (c[2] = 0; c[2] < n[2]; ++c[2])
      for (c[1] = 0; c[1] < n[1]; ++c[1])
        for (c[0] = 0; c[0] < n[0]; ++c[0]) f(c);
  }
};

// 0 where no run counts.
uint32_t thickness(const Cells& cells, const Index3& c) {
  uint32_t least = 0;
  for (size_t d = 0; d < 3; ++d) {
    Index3 lo = c, hi = c;
    while (cells.has(lo) && cells.at(lo) == cells.at(c)) --lo[d];
    while (cells.has(hi) && cells.at(hi) == cells.at(c)) ++hi[d];
    if (!cells.has(lo) || !cells.has(hi)) continue;
    const auto length = static_cast<uint32_t>(hi[d] - lo[d] - 1);
    if (least == 0 || length < least) least = length;
  }
  return least;
}

struct Found {
  Label label;
  uint64_t cells;
  Index3 first, lo, hi;
  uint32_t thinnest;
  bool at_side;
  friend bool operator==(const Found&, const Found&) = default;
};

// The components of the cells for which key() is the same and not negative.
template <class Key>
std::vector<Found> flood(const Cells& cells, Key key) {
  std::vector<Found> out;
  std::vector<bool> seen(cells.labels.size());
  const auto number = [&](const Index3& c) { return static_cast<size_t>((c[2] * cells.n[1] + c[1]) * cells.n[0] + c[0]); };
  cells.each([&](const Index3& start) {
    if (seen[number(start)] || key(start) < 0) return;
    Found found{cells.at(start), 0, start, start, start, 99, false};  // the first in the order z, y, x
    std::vector<Index3> open = {start};
    seen[number(start)] = true;
    while (!open.empty()) {
      const Index3 c = open.back();
      open.pop_back();
      ++found.cells;
      found.thinnest = std::min(found.thinnest, thickness(cells, c));
      for (size_t d = 0; d < 3; ++d) {
        found.lo[d] = std::min(found.lo[d], c[d]), found.hi[d] = std::max(found.hi[d], c[d] + 1);
        found.at_side = found.at_side || c[d] == 0 || c[d] + 1 == cells.n[d];
        for (const int step : {-1, 1}) {
          Index3 next = c;
          next[d] += step;
          if (!cells.has(next) || seen[number(next)] || key(next) != key(start)) continue;
          seen[number(next)] = true;
          open.push_back(next);
        }
      }
    }
    out.push_back(found);
  });
  std::ranges::sort(out, [](const Found& a, const Found& b) {
    const auto zyx = [](const Index3& c) { return Index3{c[2], c[1], c[0]}; };
    return a.cells != b.cells ? a.cells > b.cells : zyx(a.first) < zyx(b.first);
  });
  return out;
}

std::vector<Found> as_found(const LargestComponents& components, const RayFrame& frame, const Cells& cells, bool with_thickness) {
  std::vector<Found> out;
  for (const Component& c : components.sorted()) {
    Found found{c.label, static_cast<uint64_t>(c.cells), {c.first[2], c.first[1], c.first[0]}, {}, {}, with_thickness ? c.thinnest : 0, false};
    const std::array<int, 3> axes = {frame.u, frame.v, frame.w};
    for (size_t i = 0; i < 3; ++i) found.lo[axes[i]] = c.lo[i], found.hi[axes[i]] = c.hi[i];
    for (size_t d = 0; d < 3; ++d) found.at_side = found.at_side || found.lo[d] == 0 || found.hi[d] == cells.n[d];
    out.push_back(found);
  }
  return out;
}

void without_thickness(std::vector<Found>& list) {
  for (Found& found : list) found.thinnest = 0;
}

// Boxes, some of them as thin as a cell, and some cells at random.
Cells random_scene(std::mt19937_64& random, const Index3& n, uint32_t labels) {
  Cells out{n, std::vector<Label>(static_cast<size_t>(n[0] * n[1] * n[2]))};
  for (int i = 0; i < 14; ++i) {
    const auto label = static_cast<Label>(random() % labels);
    Index3 lo, hi;
    for (size_t d = 0; d < 3; ++d) {
      lo[d] = static_cast<int64_t>(random() % static_cast<uint64_t>(n[d]));
      hi[d] = std::min(n[d], lo[d] + 1 + static_cast<int64_t>(random() % (random() % 2 ? 3 : 25)));
    }
    out.each([&](const Index3& c) {
      for (size_t d = 0; d < 3; ++d)
        if (c[d] < lo[d] || c[d] >= hi[d]) return;
      out.labels[static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0])] = label;
    });
  }
  const uint64_t noise = random() % 60;
  for (uint64_t i = 0; i < noise; ++i) out.labels[random() % out.labels.size()] = static_cast<Label>(random() % labels);
  return out;
}

TEST_CASE("walls, components and cells at the sides are those of a search, whatever axis, chunks, cache and threads", "[check][threads]") {
  std::mt19937_64 random(1501);
  const TempFolder folder;
  size_t thin = 0, islands = 0, enclosed = 0;
  for (int round = 0; round < 36; ++round) {
    CAPTURE(round);
    const auto side = [&] { return static_cast<int64_t>(1 + random() % (round % 2 ? 30 : 12)); };
    const uint32_t labels = 2 + round % 3;
    const Cells cells = random_scene(random, {side(), side(), side()}, labels);
    Metadata meta = metadata_of(unit_grid(cells.n), round % 3, labels);
    if (round % 4 != 3) meta = with_tiny_chunks(meta);
    const auto file = folder / std::to_string(round);
    store_cells(file, meta, cells.labels);
    const GridReader reader(std::make_unique<InputFile>(file), round % 5 == 0 ? nullptr : std::make_shared<KeptChunks>(round % 5 == 1 ? 0 : 1 << 20));
    const CellFacts facts = look_at_cells(reader, 1 + round % 3, [](double) {});
    const RayFrame frame = meta.frame();

    std::map<Label, std::array<uint64_t, 10>> histogram;
    cells.each([&](const Index3& c) { ++histogram[cells.at(c)][std::min(thickness(cells, c), 9u)]; });
    for (Label label = 0; label < labels; ++label) {
      CAPTURE(label);
      const LabelFacts& of = facts.labels[label];
      uint64_t all = 0, thin_cells = 0;
      for (uint32_t k = 0; k < 10; ++k) all += histogram[label][k];
      REQUIRE(static_cast<uint64_t>(of.cells) == all);
      if (label == 0) continue;
      for (uint32_t k = 1; k <= kThickest; ++k) {
        REQUIRE(static_cast<uint64_t>(of.thin[k - 1]) == histogram[label][k]);
        if (thin_cells == 0 && histogram[label][k] > 0) {
          REQUIRE(of.thinnest == k);
          bool found = false;  // the first in the order z, y, x
          cells.each([&](const Index3& c) {
            if (found || cells.at(c) != label || thickness(cells, c) != k) return;
            found = true;
            REQUIRE(of.thinnest_at == std::array<uint32_t, 3>{static_cast<uint32_t>(c[2]), static_cast<uint32_t>(c[1]), static_cast<uint32_t>(c[0])});
          });
        }
        thin_cells += histogram[label][k];
      }
      uint64_t at_sides = 0;
      cells.each([&](const Index3& c) {
        bool side_cell = false;
        for (size_t d = 0; d < 3; ++d) side_cell = side_cell || c[d] == 0 || c[d] + 1 == cells.n[d];
        at_sides += side_cell && cells.at(c) == label;
      });
      REQUIRE(static_cast<uint64_t>(of.at_sides.cells) == at_sides);
    }

    std::vector<Found> components = flood(cells, [&](const Index3& c) { return static_cast<int>(cells.at(c)); });
    without_thickness(components);
    std::vector<Found> expected_islands, expected_enclosed;
    std::vector<bool> seen(labels);
    for (const Found& found : components)
      if (found.label == 0) {
        if (!found.at_side) expected_enclosed.push_back(found);
      } else if (seen[found.label]) expected_islands.push_back(found);
      else seen[found.label] = true;
    REQUIRE(as_found(facts.islands, frame, cells, false) == expected_islands);
    REQUIRE(as_found(facts.enclosed, frame, cells, false) == expected_enclosed);

    const std::vector<Found> expected_thin = flood(cells, [&](const Index3& c) {
      const uint32_t k = thickness(cells, c);
      return cells.at(c) != 0 && k >= 1 && k <= 2 ? static_cast<int>(cells.at(c)) : -1;
    });
    REQUIRE(as_found(facts.thin, frame, cells, true) == expected_thin);
    thin += expected_thin.size(), islands += expected_islands.size(), enclosed += expected_enclosed.size();
  }
  CHECK(thin > 100);
  CHECK(islands > 100);
  CHECK(enclosed > 5);
}

TEST_CASE("of many components the largest are kept, and all are counted", "[check]") {
  LargestComponents largest(3);
  std::mt19937_64 random(3);
  std::vector<uint32_t> order(100);
  for (uint32_t i = 0; i < 100; ++i) order[i] = i;
  std::ranges::shuffle(order, random);
  for (const uint32_t i : order) largest.add({.label = 1, .cells = 1 + i / 2, .first = {i, 0, 0}});
  CHECK(largest.number() == 100);
  CHECK(largest.cells() == 2 * 50 * 51 / 2);
  const auto kept = largest.sorted();
  REQUIRE(kept.size() == 3);
  CHECK(kept[0].first[0] == 98);
  CHECK(kept[1].first[0] == 99);
  CHECK(kept[2].first[0] == 96);
}

}  // namespace
}  // namespace teracell
