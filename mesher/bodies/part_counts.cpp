#include "mesher/bodies/part_counts.hpp"

#include <algorithm>
#include <cmath>

#include "mesher/closing/lengths.hpp"
#include "mesher/closing/surface_counts.hpp"

namespace teracell::mesher {
namespace {

struct PartBox {
  Vec3 lo = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
};

// Boxes that share a point do. A sweep along x; where too many lie beside each other there, the answer is that they do.
bool any_touch(std::vector<PartBox> boxes) {
  constexpr uint64_t kMostTries = uint64_t{1} << 27;
  std::ranges::sort(boxes, {}, [](const PartBox& b) { return b.lo[0]; });
  uint64_t tries = 0;
  std::vector<const PartBox*> open;
  for (const PartBox& b : boxes) {
    std::erase_if(open, [&](const PartBox* o) { return o->hi[0] < b.lo[0]; });
    tries += open.size();
    if (tries > kMostTries) return true;
    for (const PartBox* o : open)
      if (o->lo[1] <= b.hi[1] && b.lo[1] <= o->hi[1] && o->lo[2] <= b.hi[2] && b.lo[2] <= o->hi[2]) return true;
    open.push_back(&b);
  }
  return false;
}

}  // namespace

std::optional<SurfaceCounts> part_counts(KeptTree& kept, const std::string& glob) {
  PartTree& tree = *kept.tree;
  const std::vector<uint32_t> taken = tree.matching(PartGlob(glob));
  std::vector<PartBox> boxes;
  for (const uint32_t i : taken) {
    const Part& part = tree.parts()[i];
    if (determinant(part.matrix) == 0) return std::nullopt;
    PartBox& box = boxes.emplace_back();
    tree.for_each_vertex(part, [&](const Vec3& v) { extend(box.lo, box.hi, v); });
  }
  if (any_touch(std::move(boxes))) return std::nullopt;
  SurfaceCounts out;
  for (const uint32_t i : taken) {
    const Part& part = tree.parts()[i];
    const auto [known, fresh] = kept.counts.try_emplace(*tree.node(part).shape);
    SurfaceCounts& counts = known->second;
    if (fresh) {
      SurfaceCounter counter;
      tree.read_unplaced(part, [&](const Facet& f) { counter.add(f); });
      counts = counter.totals();
    }
    out.degenerate += counts.degenerate, out.duplicates += counts.duplicates, out.opposite += counts.opposite, out.shells += counts.shells;
  }
  return out;
}

}  // namespace teracell::mesher
