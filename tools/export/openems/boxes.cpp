#include "tools/export/openems/boxes.hpp"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::exports {
namespace {

// The place of a box among those that are joined along y or z.
std::pair<int32_t, int32_t> place(const MaterialBox& box, int axis) { return {axis == 1 ? 0 : box.lo[1], box.lo[0]}; }

bool same_across(const MaterialBox& a, const MaterialBox& b, int axis) {
  bool same = a.material == b.material;
  for (int d = 0; d < axis; ++d) same = same && a.lo[d] == b.lo[d] && a.hi[d] == b.hi[d];
  return same;
}

// `growing` ends where `pieces` begin, along y or z. Pieces that continue a box become its end, and other boxes are done. Both are in the order
// of their places.
void join(std::vector<MaterialBox>& growing, std::vector<MaterialBox>& pieces, int axis, std::vector<MaterialBox>& done) {
  auto at = growing.begin();
  for (MaterialBox& piece : pieces) {
    for (; at != growing.end() && place(*at, axis) < place(piece, axis); ++at) done.push_back(*at);
    if (at != growing.end() && same_across(*at, piece, axis)) piece.lo[axis] = (at++)->lo[axis];
  }
  done.insert(done.end(), at, growing.end());
  growing.swap(pieces);
}

}  // namespace

void BoxMerger::add(const Layer& layer, int32_t z) {
  const auto check = [&](size_t boxes) {
    if (boxes > most_)
      throw UsageError(fmt::format(
          "expected cells that make up at most {} boxes, found more up to layer {} of z: take --region, or --level for coarser cells", most_, z));
  };
  std::vector<MaterialBox> rectangles, growing, pieces;
  for (size_t y = 0; y + 1 < layer.rows.size(); ++y) {
    pieces.clear();
    const auto row = static_cast<int32_t>(y);
    for (const CellRun& run : layer.row(row))
      if (run.in_mesh()) pieces.push_back({run.what, {run.begin, row, z}, {run.end, row + 1, z + 1}});
    join(growing, pieces, 1, rectangles);
    check(done_.size() + rectangles.size() + growing.size());
  }
  rectangles.insert(rectangles.end(), growing.begin(), growing.end());
  std::ranges::sort(rectangles, {}, [](const MaterialBox& r) { return place(r, 2); });
  join(growing_, rectangles, 2, done_);
  check(done_.size() + growing_.size());
}

std::vector<MaterialBox> BoxMerger::finish() {
  done_.insert(done_.end(), growing_.begin(), growing_.end());
  std::ranges::sort(done_, {}, [](const MaterialBox& b) { return std::tuple(b.material, b.lo[2], b.lo[1], b.lo[0]); });
  return std::move(done_);
}

}  // namespace teracell::exports
