#include "tools/export/openfoam/face_patches.hpp"

#include <algorithm>
#include <tuple>

namespace teracell::exports::foam {
namespace {

// A chunk of links is decoded once for each read, so a read takes as many layers as there is room for in the worst case, noise.
constexpr int64_t kCellsAtOnce = 4 << 20;

auto place(const PatchRun& r) { return std::tuple(r.z, r.y, r.begin); }

}  // namespace

void FacePatches::read(int64_t z) {
  if (z < end_) return;
  end_ = std::min(size_[2], z + std::max<int64_t>(1, kCellsAtOnce / (size_[0] * size_[1])));
  const auto& [lo, hi] = e_.box;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<PatchRun>& runs = runs_[static_cast<size_t>(axis)];
    runs.clear();
    const int64_t first = axis == 2 && z > 0 ? z - 1 : z;  // the faces below the first layer belong to cells below it
    links_.for_each(axis, {{lo[0], lo[1], lo[2] + first}, {hi[0], hi[1], lo[2] + end_}}, [&](std::span<const CellLink> found) {
      e_.progress(0);
      for (const CellLink& l : found) {
        if (l.patch == kNoPatch) continue;
        const auto x = static_cast<int32_t>(l.cell[0] - lo[0]);
        runs.push_back({static_cast<int32_t>(l.cell[2] - lo[2]), static_cast<int32_t>(l.cell[1] - lo[1]), x, x + 1, l.patch});
      }
    });
    std::ranges::sort(runs, {}, place);
    size_t kept = 0;
    for (const PatchRun& r : runs) {
      PatchRun* const last = kept > 0 ? &runs[kept - 1] : nullptr;
      if (last != nullptr && last->z == r.z && last->y == r.y && last->end == r.begin && last->patch == r.patch) last->end = r.end;
      else runs[kept++] = r;
    }
    runs.resize(kept);
  }
}

std::span<const PatchRun> FacePatches::row(int axis, int64_t y, int64_t z) const {
  const auto found = std::ranges::equal_range(runs_[static_cast<size_t>(axis)], std::tuple(z, y), {},
                                              [](const PatchRun& r) { return std::tuple(int64_t{r.z}, int64_t{r.y}); });
  return {found.begin(), found.end()};
}

}  // namespace teracell::exports::foam
