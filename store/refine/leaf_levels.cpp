#include "store/refine/leaf_levels.hpp"

#include <algorithm>

#include "store/base/wanted.hpp"

namespace teracell::inline store {
namespace {

constexpr int kBlock = 7;  // the largest subtrees whose leaves are asked for: each makes what it stands on once

}  // namespace

Box cells_below(const SliceView& view) {
  Box box = RayFrame::along(view.axis).box({view.u0, view.v0, view.index}, {view.u1, view.v1, view.index + 1});
  for (size_t d = 0; d < 3; ++d) box.lo[d] <<= view.level, box.hi[d] <<= view.level;
  return box;
}

std::vector<uint8_t> leaf_levels(const Leaves& leaves, const SliceView& view) {
  const RayFrame f = RayFrame::along(view.axis);
  const int64_t width = view.u1 - view.u0;
  std::vector<uint8_t> out(static_cast<size_t>(width * (view.v1 - view.v0)), kFiner);
  const auto fill = [&](int level, const Index3& cell) {  // of its level, which is not below the view's
    const int by = level - view.level;
    const int64_t u0 = std::max(view.u0, cell[f.u] << by), u1 = std::min(view.u1, (cell[f.u] + 1) << by);
    const int64_t v0 = std::max(view.v0, cell[f.v] << by), v1 = std::min(view.v1, (cell[f.v] + 1) << by);
    for (int64_t v = v0; v < v1; ++v) std::fill_n(out.begin() + (v - view.v0) * width + u0 - view.u0, u1 - u0, static_cast<uint8_t>(level));
  };
  const Box box = cells_below(view);
  Leaves::Walk walk(leaves, box, view.level < 3 ? kBlock : view.level);
  while (const auto subtree = walk.next()) {
    Wanted::stop_if_not();
    if (subtree->level <= leaves.coarsest() && !leaves.is_split(subtree->level, subtree->cell)) {
      fill(subtree->level, subtree->cell);
    } else if (view.level < 3) {
      const Index3 first = subtree->first();
      for (const LeafInSubtree& leaf : leaves.leaves_of(*subtree, box)) {
        const auto level = static_cast<int>(leaf.level);
        if (level < view.level) continue;
        Index3 cell = cell_of_code(leaf.code);
        for (size_t d = 0; d < 3; ++d) cell[d] = (first[d] + cell[d]) >> level;
        fill(level, cell);
      }
    }
  }
  return out;
}

}  // namespace teracell::store
