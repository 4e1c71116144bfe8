#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/warnings.hpp"
#include "store/text.hpp"

namespace teracell {
namespace {

using What = TallyKey::What;

TallyKey key_of(What what, size_t of, int axis) { return {what, static_cast<uint32_t>(of), static_cast<uint8_t>(axis)}; }

std::string lower_side_warning(size_t b, int axis, const Grid& grid, const Tallies& tallies) {
  const TallyKey key = key_of(What::kLowerSide, b, axis);
  const Tally* found = tallies.find(key);
  if (!found) return "";
  return fmt::format("lies on the domain's lower side along {} on {} through sample points, the first at {}: the cells there would lie beyond it. "
                     "Let the domain begin lower if they matter",
                     axis_name(axis), plural(found->number, "line"), text(place_of(key, *found, grid)));
}

// How thick the body's box is along an axis, in cells, those in it on average.
double thickness_in_cells(const BodyFacets& found, int d, const Axis& axis) {
  const double extent = found.hi[d] - found.lo[d], lo = std::clamp(found.lo[d], axis.min(), axis.max()), hi = std::clamp(found.hi[d], axis.min(), axis.max());
  const int64_t first = axis.cell_at(lo), last = axis.cell_at(hi);
  return extent / ((axis.plane(last + 1) - axis.plane(first)) / static_cast<double>(last + 1 - first));
}

// Empty unless the box lies beside the domain along some axis.
std::string beside_domain(const BodyFacets& found, const Grid& grid) {
  std::vector<std::string> sides;
  for (int d = 0; d < 3; ++d)
    if (found.hi[d] < grid.axis[d].min() || found.lo[d] > grid.axis[d].max())
      sides.push_back(fmt::format("it spans {} from {:.6g} to {:.6g}, the domain from {:.6g} to {:.6g}", axis_name(d), found.lo[d], found.hi[d], grid.axis[d].min(), grid.axis[d].max()));
  return fmt::format("{}", fmt::join(sides, "; "));
}

// A body may be small by intention: what is said below is why, not that it is wrong.
constexpr uint64_t kFewCells = 8;

std::string few_cells_warning(const Scene& scene, size_t b, const BodyFacets& found, const Plan& plan, const CastTotals& totals) {
  const SceneBody& body = scene.bodies[b];
  const Grid& grid = plan.meta.grid;
  const auto cells = static_cast<uint64_t>(totals.cells[b]);
  const std::string owns = cells == 0 ? "owns no cell" : fmt::format("owns only {}", plural(cells, "cell"));
  if (const std::string beside = beside_domain(found, grid); !beside.empty()) return fmt::format("{}: it lies outside the domain: {}", owns, beside);

  std::vector<std::string> why;
  if (totals.covered[b] > 0) why.push_back(fmt::format("stronger bodies own {} of {} cells in it", totals.covered[b], totals.covered[b] + totals.cells[b]));
  std::vector<std::string> thickness;
  double thinnest = HUGE_VAL;
  bool flat = false;
  for (int d = 0; d < 3; ++d) {
    const double n = thickness_in_cells(found, d, grid.axis[d]);
    thinnest = std::min(thinnest, n);
    flat |= found.lo[d] == found.hi[d];
    thickness.push_back(fmt::format("{:.3g}", n));
  }
  const bool sheet = body.kind == Kind::kSheet;
  const bool open = !found.closed.holes.empty();
  if (flat && !sheet) why.push_back(open ? "it is open and flat, so it encloses nothing" : "it is flat, so it encloses nothing");
  why.push_back(fmt::format("its box is {} cells wide along x, y, z", fmt::join(thickness, " x ")));
  const TallyKey key = key_of(What::kPairs, b, plan.rays.axis);
  const Tally* lost = totals.tallies.find(key);
  if (lost) why.push_back(fmt::format("rays along {} enter and leave it between two sample points {}, the first at {}", axis_name(plan.rays.axis),
                                      lost->number == 1 ? "once" : fmt::format("{} times", lost->number), text(place_of(key, *lost, grid))));
  const char* advice = "";
  if (!sheet && totals.covered[b] == 0) {
    if (flat || (open && thinnest < 1)) advice = ". If it is a surface without thickness, \"kind\": \"sheet\" gives it the cells that it passes through";
    else if ((lost || thinnest < 1) && body.thin != Thin::kKeep) advice = ". \"thin\": \"keep\" gives it the cells that its thin parts lie in; smaller cells would too";
  }
  return fmt::format("{}: {}{}", owns, fmt::join(why, "; "), advice);
}

}  // namespace

std::vector<std::string> cell_warnings(const Scene& scene, const Bodies& bodies, const Plan& plan, const CastTotals& totals) {
  constexpr size_t kShown = 20;  // scenes may have bodies by the thousand that are small by intention
  std::vector<std::string> out;
  const auto say = [&](size_t b, const std::string& words) { out.push_back(fmt::format("body '{}' {}", scene.bodies[b].name, words)); };
  size_t few = 0;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    if (totals.cells[b] < kFewCells && ++few <= kShown) say(b, few_cells_warning(scene, b, bodies.bodies[b], plan, totals));
    for (int axis = 0; axis < 3; ++axis)
      if (const std::string words = lower_side_warning(b, axis, plan.meta.grid, totals.tallies); !words.empty()) say(b, words);
  }
  if (few > kShown) out.push_back(fmt::format("{} with fewer than {} cells or none: the report has the cells of each", few - kShown == 1 ? "one more body" : fmt::format("{} more bodies", few - kShown), kFewCells));
  return out;
}

}  // namespace teracell
