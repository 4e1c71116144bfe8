// Lines between leaves against the leaves themselves.
#include "server/picture/leaf_lines.hpp"

#include <numeric>

#include "tests/support/meshed.hpp"
#include "tests/support/random.hpp"
#include "tests/support/refined.hpp"

namespace teracell::server {
namespace {

using namespace testing;

TEST_CASE("A pixel is drawn on where a leaf begins that is at least two pixels wide or high, in the colour of its level") {
  const TempFolder folder;
  for (int seed = 0; seed < 12; ++seed) {
    std::mt19937_64 random(static_cast<uint64_t>(seed));
    const Index3 n{random_int(random, 3, 40), random_int(random, 3, 40), random_int(random, 3, 40)};
    const std::vector<Label> cells = blobs(random, n, 2);
    const Metadata meta = metadata_of(unit_grid(n), seed % 3, 2);
    const GridReader reader = reader_of(meta, cells);
    const Refinement refinement{.coarsest = 3, .layers = 1};
    const int axis = seed / 3 % 3;
    const RayFrame f = RayFrame::along(axis);
    const SliceView view = whole_slice(meta, axis, n[axis] / 2, 0);
    const int64_t each = 1 + seed % 2;  // pixels for each cell
    std::vector<int64_t> columns, rows;
    for (int64_t i = 0; i < n[f.u] * each; ++i) columns.push_back(i / each);
    for (int64_t i = 0; i < n[f.v] * each; ++i) rows.push_back(i / each);

    std::vector<std::vector<int>> expected(rows.size(), std::vector<int>(columns.size(), -1));
    for (const Leaf& leaf : leaves_by_definition(meta, cells, refinement, cells_below(view))) {
      const int64_t u0 = leaf.first()[f.u] * each, v0 = leaf.first()[f.v] * each, size = (int64_t{1} << leaf.level) * each;
      const int64_t u1 = std::min(u0 + size, std::ssize(columns)), v1 = std::min(v0 + size, std::ssize(rows));
      for (int64_t v = v0; v < v1; ++v)
        for (int64_t u = u0; u < u1; ++u)
          if ((u == u0 && u1 - u0 > 1) || (v == v0 && v1 - v0 > 1)) expected[static_cast<size_t>(v)][static_cast<size_t>(u)] = leaf.level;
    }

    Leaves leaves(reader, refinement, folder.path());
    leaves.prepare(cells_below(view), 1, [](double) {});
    SetColors colors(meta, 0);
    LeafLines lines(leaves, view, columns, rows, 1, colors);
    constexpr uint16_t kUntouched = 60000;
    INFO("seed " << seed);
    for (int64_t v = std::ssize(rows); v-- > 0;) {
      std::vector<uint16_t> pixels(columns.size(), kUntouched);
      lines.draw(v, pixels);
      for (size_t u = 0; u < pixels.size(); ++u) {
        const int level = expected[static_cast<size_t>(v)][u];
        REQUIRE((pixels[u] == kUntouched) == (level < 0));
        if (level >= 0) REQUIRE(colors.colors()[pixels[u]] == LeafLines::color(level));
      }
    }
  }
}

}  // namespace
}  // namespace teracell::server
