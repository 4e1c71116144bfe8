// What is found in the cells, against a search cell by cell.
#include "store/check/cells.hpp"

#include "store/read/kept_chunks.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"
#include "tests/support/thickness_search.hpp"

namespace teracell {
namespace {

using namespace testing;

struct Found {
  Label label;
  uint64_t cells;
  Index3 first, lo, hi;  // first: of the thinnest cells
  uint32_t thinnest;
  bool at_side;
  friend bool operator==(const Found&, const Found&) = default;
};

Index3 zyx(const Index3& c) { return {c[2], c[1], c[0]}; }

// The components of the cells for which key() is the same and not negative: through faces, or, with a thickness of each cell, through edges and
// corners, too.
template <class Key>
std::vector<Found> flood(const Cells& cells, const std::vector<uint32_t>* thickness, Key key) {
  std::vector<Found> out;
  std::vector<bool> seen(cells.labels.size());
  const auto thick = [&](const Index3& c) { return thickness ? (*thickness)[cells.number(c)] : 0; };
  Cells::each({0, 0, 0}, cells.n, [&](const Index3& start) {
    if (seen[cells.number(start)] || key(start) < 0) return;
    Found found{cells.at(start), 0, start, start, start, thick(start), false};
    std::vector<Index3> open = {start};
    seen[cells.number(start)] = true;
    while (!open.empty()) {
      const Index3 c = open.back();
      open.pop_back();
      ++found.cells;
      if (std::pair(thick(c), zyx(c)) < std::pair(found.thinnest, zyx(found.first))) found.thinnest = thick(c), found.first = c;
      for (size_t d = 0; d < 3; ++d) {
        found.lo[d] = std::min(found.lo[d], c[d]), found.hi[d] = std::max(found.hi[d], c[d] + 1);
        found.at_side = found.at_side || c[d] == 0 || c[d] + 1 == cells.n[d];
      }
      const auto [lo, hi] = around(c, 1, cells.n);
      Cells::each(lo, hi, [&](const Index3& next) {
        if (seen[cells.number(next)] || key(next) != key(start) || (!thickness && squared(c, next) > 1)) return;
        seen[cells.number(next)] = true;
        open.push_back(next);
      });
    }
    out.push_back(found);
  });
  std::ranges::sort(out, [](const Found& a, const Found& b) { return a.cells != b.cells ? a.cells > b.cells : zyx(a.first) < zyx(b.first); });
  return out;
}

std::vector<Found> as_found(const LargestComponents& components, const RayFrame& frame, const Cells& cells) {
  std::vector<Found> out;
  for (const Component& c : components.sorted()) {
    Found found{c.label, static_cast<uint64_t>(c.cells), {c.first[2], c.first[1], c.first[0]}, {}, {}, c.thinnest, false};
    const std::array<int, 3> axes = {frame.u, frame.v, frame.w};
    for (size_t i = 0; i < 3; ++i) found.lo[axes[i]] = c.lo[i], found.hi[axes[i]] = c.hi[i];
    for (size_t d = 0; d < 3; ++d) found.at_side = found.at_side || found.lo[d] == 0 || found.hi[d] == cells.n[d];
    out.push_back(found);
  }
  return out;
}

// Boxes, some of them as thin as a cell, and some cells at random.
Cells random_scene(std::mt19937_64& random, const Index3& n, uint32_t labels) {
  Cells out(n);
  for (int i = 0; i < 14; ++i) {
    const auto label = static_cast<Label>(random() % labels);
    Index3 lo, hi;
    for (size_t d = 0; d < 3; ++d) {
      lo[d] = static_cast<int64_t>(random() % static_cast<uint64_t>(n[d]));
      hi[d] = std::min(n[d], lo[d] + 1 + static_cast<int64_t>(random() % (random() % 2 ? 3 : 25)));
    }
    Cells::each({0, 0, 0}, n, [&](const Index3& c) {
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
  size_t thin = 0, narrow = 0, islands = 0, enclosed = 0;
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
    const CheckOptions options{.threads = 1 + round % 3, .thin_cells = 1 + round % 8 * 0.5, .narrow_cells = round % 2 * 4.};
    const CellFacts facts = look_at_cells(reader, std::vector<bool>(labels), options, [](double) {});
    const RayFrame frame = meta.frame();

    std::vector<uint32_t> thickness(cells.labels.size());
    for (Label label = 0; label < labels; ++label) std::ranges::transform(thickness, by_search(cells, label), thickness.begin(), std::plus());
    const auto thick = [&](const Index3& c) { return thickness[cells.number(c)]; };
    std::map<Label, std::array<uint64_t, 17>> histogram;
    Cells::each({0, 0, 0}, cells.n, [&](const Index3& c) { ++histogram[cells.at(c)][thick(c)]; });
    for (Label label = 0; label < labels; ++label) {
      CAPTURE(label);
      const LabelFacts& of = facts.labels[label];
      uint64_t all = 0, thin_cells = 0;
      for (const uint64_t count : histogram[label]) all += count;
      REQUIRE(static_cast<uint64_t>(of.cells) == all);
      if (label == 0) continue;
      for (uint32_t k = 2; k < kThickest; ++k) {
        REQUIRE(static_cast<uint64_t>(of.thin[k / 2 - 1]) == histogram[label][k / 2 * 2] + histogram[label][k / 2 * 2 + 1]);
        if (thin_cells == 0 && histogram[label][k] > 0) {
          REQUIRE(of.thinnest == k);
          bool found = false;  // the first in the order z, y, x
          Cells::each({0, 0, 0}, cells.n, [&](const Index3& c) {
            if (found || cells.at(c) != label || thick(c) != k) return;
            found = true;
            REQUIRE(of.thinnest_at == std::array<uint32_t, 3>{static_cast<uint32_t>(c[2]), static_cast<uint32_t>(c[1]), static_cast<uint32_t>(c[0])});
          });
        }
        thin_cells += histogram[label][k];
      }
      uint64_t at_sides = 0;
      Cells::each({0, 0, 0}, cells.n, [&](const Index3& c) {
        bool side_cell = false;
        for (size_t d = 0; d < 3; ++d) side_cell = side_cell || c[d] == 0 || c[d] + 1 == cells.n[d];
        at_sides += side_cell && cells.at(c) == label;
      });
      REQUIRE(static_cast<uint64_t>(of.at_sides.cells) == at_sides);
    }

    const std::vector<Found> components = flood(cells, nullptr, [&](const Index3& c) { return static_cast<int>(cells.at(c)); });
    std::vector<Found> expected_islands, expected_enclosed;
    std::vector<bool> seen(labels);
    for (const Found& found : components)
      if (found.label == 0) {
        if (!found.at_side) expected_enclosed.push_back(found);
      } else if (seen[found.label]) expected_islands.push_back(found);
      else seen[found.label] = true;
    REQUIRE(as_found(facts.islands, frame, cells) == expected_islands);
    REQUIRE(as_found(facts.enclosed, frame, cells) == expected_enclosed);

    const auto regions_below = [&](bool background, double wide) {
      std::vector<Found> all = flood(cells, &thickness, [&](const Index3& c) {
        return (cells.at(c) == 0) == background && thick(c) < 2 * wide ? static_cast<int>(cells.at(c)) : -1;
      });
      std::erase_if(all, [](const Found& found) { return found.cells < kFewCells; });
      return all;
    };
    const std::vector<Found> expected_thin = regions_below(false, options.thin_cells), expected_narrow = regions_below(true, options.narrow_cells);
    REQUIRE(as_found(facts.thin, frame, cells) == expected_thin);
    REQUIRE(as_found(facts.narrow, frame, cells) == expected_narrow);
    narrow += expected_narrow.size();
    thin += expected_thin.size(), islands += expected_islands.size(), enclosed += expected_enclosed.size();
  }
  CHECK(thin > 50);
  CHECK(narrow > 10);
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
