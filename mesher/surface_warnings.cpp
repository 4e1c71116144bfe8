#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "mesher/warnings.hpp"
#include "store/text.hpp"

namespace teracell {
namespace {

double longest_side(const Grid& grid) {
  double longest = 0;
  for (const Axis& a : grid.axis) longest = std::max(longest, a.max() - a.min());
  return longest;
}

// Whether to care about holes, the widest of which is so wide.
std::string verdict(double width, double cells, const Grid& grid, bool loose) {
  if (loose) return "No two facets share an edge, so they enclose nothing: are vertices that should be one further apart than the stitch length?";
  if (cells < 2) return "That is below 2 cells: harmless on this grid";
  if (width * 10 < longest_side(grid)) return "Inside ends at the caps: look there if those few cells matter";
  return "Inside ends at the caps, so they shape the body: look whether it should be open there";
}

// The axis along which terrain would be extruded, if a hole looks like the edge of one: it spans the domain along the two
// others, and goes up and down with the surface, which the missing side of a box does not.
std::optional<int> terrain_axis(const Hole& hole, const BodyFacets& found, const Grid& grid) {
  std::vector<int> narrow;
  for (int d = 0; d < 3; ++d)
    if (hole.hi[d] - hole.lo[d] < 0.8 * (grid.axis[d].max() - grid.axis[d].min())) narrow.push_back(d);
  if (narrow.size() > 1) return std::nullopt;
  const int axis = narrow.empty() ? 2 : narrow[0];
  if (hole.hi[axis] - hole.lo[axis] < 0.2 * (found.hi[axis] - found.lo[axis])) return std::nullopt;
  return axis;
}

std::string seam_note(const Scene& scene, const ClosedBody& closed, const Grid& grid) {
  const Seams& seams = closed.seams;
  if (seams.number == 0 && seams.collapsed == 0) return "";
  std::string out = "was stitched";
  if (seams.number > 0) out += fmt::format(" along {}, {:.4g} {} in all", plural(seams.number, "seam"), seams.length, scene.units);
  if (seams.collapsed > 0)
    out += fmt::format("{} {} within the stitch length of each other, which closes or narrows what lay between them", seams.number > 0 ? " and at" : " at",
                       plural(seams.collapsed, "open edge"));
  out += fmt::format(", over gaps of up to {:.3g} {} (the stitch length is {:.3g} {})", seams.widest_gap, scene.units, closed.stitch, scene.units);
  double shortest = HUGE_VAL;
  for (const Axis& a : grid.axis) shortest = std::min(shortest, a.shortest_cell());
  if (closed.stitch > 2 * shortest) out += ". That is longer than two cells: look whether it closed what should be open";
  return out;
}

std::string open_warning(const Scene& scene, const SceneBody& body, const BodyFacets& found, const Grid& grid) {
  const ClosedBody& closed = found.closed;
  uint64_t edges = 0, capped = 0;
  double area = 0, most_cells = 0;
  const Hole* largest = nullptr;
  for (const Hole& h : closed.holes) {
    if (h.extruded) continue;
    ++capped;
    edges += h.edges, area += h.cap_area;
    most_cells = std::max(most_cells, in_cells(h.width, h.at, grid));
    if (!largest) largest = &h;  // they come in this order
  }
  if (!largest) return "";
  const bool one = capped == 1, loose = capped == found.file.facets && edges == 3 * capped;
  std::string out = fmt::format("is open: {} ({}), closed by {} of {:.4g} {}^2 in all; the {} is {:.4g} {} across, {:.3g} cells, with a gap of {:.3g} {}, {:.3g} cells, at {}. {}",
                                plural(capped, "hole"), plural(edges, "edge"), one ? "a cap" : "caps", area, scene.units, one ? "hole" : "largest",
                                largest->diameter, scene.units, in_cells(largest->diameter, largest->at, grid), largest->width, scene.units,
                                in_cells(largest->width, largest->at, grid), text(largest->at), verdict(largest->diameter, most_cells, grid, loose));
  if (closed.cut_from_others) out += fmt::format(". Part '{}' is cut off there from parts that were left out", body.part);
  if (const auto axis = terrain_axis(*largest, found, grid); axis && !loose && body.closing.way == Closing::Way::kCap)
    out += fmt::format(". If it is terrain, a sheet over the whole domain, give it \"closing\": {{\"extrude\": \"-{0}\"}} or --closing extrude:-{0}: "
                       "then all that is below it is inside", axis_name(*axis));
  return out;
}

bool uses_parity(const ClosedBody& closed) {
  return std::ranges::any_of(closed.fill, [](const FillChoice& f) { return f.rule != Fill::kNonzero; });
}

std::string flip_warning(const ClosedBody& closed) {
  if (closed.flips.empty()) return "";
  uint64_t edges = 0;
  for (const Flip& f : closed.flips) edges += f.edges;
  const char* parity = "Inside such a shell is decided by parity, for which orientation does not matter; only where the shell overlaps itself is it hollow";
  const char* winding = "Fill nonzero was asked for, so each curve is a hole, closed by caps: fill auto would decide by parity instead";
  return fmt::format("has facets that face the other way than their neighbours: {} along {}, the first at {}. {}", plural(edges, "edge"),
                     plural(closed.flips.size(), "curve"), text(closed.flips[0].at), uses_parity(closed) ? parity : winding);
}

std::string double_warning(const ClosedBody& closed) {
  for (const FillChoice& f : closed.fill)
    if (f.rule == Fill::kDistinct && f.why != "asked for") return "is given twice, or partly: " + f.why;
  return "";
}

}  // namespace

std::vector<std::string> surface_warnings(const Scene& scene, const SceneBody& body, const BodyFacets& found, const Grid& grid,
                                       const SurfaceCounts& counts) {
  const ClosedBody& closed = found.closed;
  std::vector<std::string> out = {seam_note(scene, closed, grid), open_warning(scene, body, found, grid), flip_warning(closed), double_warning(closed)};
  const bool evenodd = std::ranges::any_of(closed.fill, [](const FillChoice& f) { return f.rule == Fill::kEvenodd; });
  if (evenodd && counts.duplicates > 0)
    out.push_back(fmt::format("has {}, and shells whose inside is decided by parity: there a facet that is given twice counts as none",
                              plural(counts.duplicates, "duplicate facet")));
  std::erase(out, "");
  return out;
}

std::string text(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p[0], p[1], p[2]); }

double in_cells(double length, const Vec3& at, const Grid& grid) {
  double narrowest = HUGE_VAL;
  for (int d = 0; d < 3; ++d) {
    const Axis& a = grid.axis[d];
    const int64_t i = a.cell_at(std::clamp(at[d], a.min(), a.max()));
    narrowest = std::min(narrowest, a.plane(i + 1) - a.plane(i));
  }
  return length / narrowest;
}

}  // namespace teracell
