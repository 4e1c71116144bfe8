#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/report/warnings.hpp"
#include "store/grid/number_text.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

using What = TallyKey::What;

TallyKey key_of(What what, size_t of, int axis) { return {what, static_cast<uint32_t>(of), static_cast<uint8_t>(axis)}; }

std::string lower_side_warning(size_t b, int axis, const Grid& grid, const Tallies& tallies) {
  const TallyKey key = key_of(What::kLowerSide, b, axis);
  const Tally* found = tallies.find(key);
  if (!found) return "";
  return fmt::format(
      "lies exactly on the domain's lower side along {}, on {} through sample points, the first at {}. The cells that it would own there lie outside "
      "the domain. If they matter, let the domain begin lower",
      axis_name(axis), plural(found->number, "line"), place_text(place_of(key, *found, grid)));
}

// The extent of the body's box along an axis, in cells of the average length within the box.
double thickness_in_cells(const BodyFacets& found, int d, const Axis& axis) {
  const double extent = found.hi[d] - found.lo[d], lo = std::clamp(found.lo[d], axis.min(), axis.max()),
               hi = std::clamp(found.hi[d], axis.min(), axis.max());
  const int64_t first = axis.cell_at(lo), last = axis.cell_at(hi);
  return extent / ((axis.plane(last + 1) - axis.plane(first)) / static_cast<double>(last + 1 - first));
}

// Says along which axes the box lies outside the domain; empty if there are none.
std::string beside_domain(const BodyFacets& found, const Grid& grid) {
  std::vector<std::string> sides;
  for (int d = 0; d < 3; ++d)
    if (found.hi[d] < grid.axis[d].min() || found.lo[d] > grid.axis[d].max())
      sides.push_back(fmt::format("it spans {0} from {1:.6g} to {2:.6g}, but the domain spans {0} from {3:.6g} to {4:.6g}", axis_name(d), found.lo[d],
                                  found.hi[d], grid.axis[d].min(), grid.axis[d].max()));
  return fmt::format("{}", fmt::join(sides, "; "));
}

// A body with fewer cells is reported. It may be small by intention, so the warning gives the reason and does not call it wrong.
constexpr uint64_t kFewCells = 8;

std::string few_cells_warning(const Scene& scene, size_t b, const BodyFacets& found, const Plan& plan, const CastTotals& totals) {
  const SceneBody& body = scene.bodies[b];
  const Grid& grid = plan.meta.grid;
  const auto cells = static_cast<uint64_t>(totals.cells[b]);
  const std::string owns = cells == 0 ? "owns no cell" : fmt::format("owns only {}", plural(cells, "cell"));
  if (const std::string beside = beside_domain(found, grid); !beside.empty())
    return fmt::format("{} because it lies outside the domain: {}. Check its units and its place", owns, beside);

  std::vector<std::string> why;
  if (totals.covered[b] > 0)
    why.push_back(fmt::format("stronger bodies own {} of the {} cells inside it", totals.covered[b], totals.covered[b] + totals.cells[b]));
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
  if (lost)
    why.push_back(fmt::format("rays along {} enter and leave it between two neighbouring sample points {}, the first at {}",
                              axis_name(plan.rays.axis), lost->number == 1 ? "once" : fmt::format("{} times", lost->number),
                              place_text(place_of(key, *lost, grid))));
  const char* advice = "";
  if (!sheet && totals.covered[b] == 0) {
    if (flat || (open && thinnest < 1))
      advice = ". If it is a surface without thickness, set \"kind\": \"sheet\", which gives it the cells that it passes through";
    else if ((lost || thinnest < 1) && body.thin != Thin::kKeep)
      advice = ". Set \"thin\": \"keep\", which gives it the cells that its thin parts lie in, or use smaller cells";
  }
  return fmt::format("{}: {}{}", owns, fmt::join(why, "; "), advice);
}

}  // namespace

std::vector<std::string> cell_warnings(const Scene& scene, const Bodies& bodies, const Plan& plan, const CastTotals& totals) {
  constexpr size_t kShown = 20;  // a scene may have thousands of bodies that are small by intention
  std::vector<std::string> out;
  const auto say = [&](size_t b, const std::string& words) { out.push_back(fmt::format("body '{}' {}", scene.bodies[b].name, words)); };
  size_t few = 0;
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    if (totals.cells[b] < kFewCells && ++few <= kShown) say(b, few_cells_warning(scene, b, bodies.bodies[b], plan, totals));
    for (int axis = 0; axis < 3; ++axis)
      if (const std::string words = lower_side_warning(b, axis, plan.meta.grid, totals.tallies); !words.empty()) say(b, words);
  }
  if (few > kShown)
    out.push_back(fmt::format("{} fewer than {} cells or none: the report gives the number of cells of each body",
                              few - kShown == 1 ? "one more body owns" : fmt::format("{} more bodies own", few - kShown), kFewCells));
  return out;
}

}  // namespace teracell::mesher
