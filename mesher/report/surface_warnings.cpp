#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "mesher/report/warnings.hpp"
#include "store/grid/number_text.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

double longest_side(const Grid& grid) {
  double longest = 0;
  for (const Axis& a : grid.axis) longest = std::max(longest, a.max() - a.min());
  return longest;
}

// Whether to care about holes and what to do. `width` is that of the widest hole, `cells` the widest gap.
std::string verdict(double width, double cells, const Grid& grid, bool loose) {
  if (loose)
    return "No two facets share an edge, so they enclose nothing. If vertices that should be equal lie further apart than the stitch length, weld them, "
           "or set a longer \"stitch\"";
  if (cells < 2) return "Every gap is narrower than 2 cells, so the caps are harmless on this grid";
  if (width * 10 < longest_side(grid)) return "The caps decide which of the few cells there are inside: check the place if they matter";
  return "The caps are large enough to shape the body. Check whether it should be open there; if not, close the surface";
}

// The axis along which terrain would be extruded, if the hole looks like the edge of terrain: it spans the domain along the two
// other axes, and rises and falls with the surface. (The missing side of a box does not.)
std::optional<int> terrain_axis(const Hole& hole, const BodyFacets& found, const Grid& grid) {
  std::vector<int> narrow;
  for (int d = 0; d < 3; ++d)
    if (hole.hi[d] - hole.lo[d] < 0.8 * (grid.axis[d].max() - grid.axis[d].min())) narrow.push_back(d);
  if (narrow.size() > 1) return std::nullopt;
  const int axis = narrow.empty() ? 2 : narrow[0];
  if (hole.hi[axis] - hole.lo[axis] < 0.2 * (found.hi[axis] - found.lo[axis])) return std::nullopt;
  return axis;
}

double shortest_cell(const Grid& grid) {
  double shortest = HUGE_VAL;
  for (const Axis& a : grid.axis) shortest = std::min(shortest, a.shortest_cell());
  return shortest;
}

std::string seam_note(const Scene& scene, const ClosedBody& closed, const Grid& grid) {
  const Seams& seams = closed.seams;
  if (seams.number == 0 && seams.collapsed == 0) return "";
  std::string out = "was stitched";
  if (seams.number > 0) out += fmt::format(" along {}, {} {} in all", plural(seams.number, "seam"), number_text(seams.length, 4), scene.units);
  if (seams.collapsed > 0)
    out += fmt::format("{} {} with both ends within the stitch length of each other, which closes or narrows the holes there",
                       seams.number > 0 ? ", and at" : " at", plural(seams.collapsed, "open edge"));
  out += fmt::format(". The widest gap that was stitched is {} {}; the stitch length is {} {}. ", number_text(seams.widest_gap, 3), scene.units,
                     number_text(closed.stitch, 3), scene.units);
  const double cell = shortest_cell(grid);
  if (closed.stitch > 2 * cell)
    return out + "This is longer than two cells: check that nothing was closed that should be open, or set a shorter \"stitch\"";
  if (seams.widest_gap < cell) return out + "Gaps narrower than a cell are harmless on this grid";
  return out + "Some gaps are wider than a cell: check the cells along them if they matter";
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
    if (!largest) largest = &h;  // the largest is the first
  }
  if (!largest) return "";
  const bool one = capped == 1, loose = capped == found.file.facets && edges == 3 * capped;
  const auto length = [&](double x, int digits) {
    return fmt::format("{} {} ({} cells)", number_text(x, digits), scene.units, number_text(in_cells(x, largest->at, grid), 3));
  };
  std::string out = fmt::format("is open: it has {} ({}), closed by {} of {} {}²{}. The {} is {} across, with a gap of {}, at {}. {}",
                                plural(capped, "hole"), plural(edges, "edge"), one ? "a cap" : "caps", number_text(area, 4), scene.units,
                                one ? "" : " in all", one ? "hole" : "largest hole", length(largest->diameter, 4), length(largest->width, 3),
                                place_text(largest->at), verdict(largest->diameter, most_cells, grid, loose));
  if (closed.cut_from_others)
    out += fmt::format(". Part '{}' is cut off from parts of the file that the scene leaves out: make bodies of these too if they belong to it",
                       body.part);
  if (const auto axis = terrain_axis(*largest, found, grid); axis && !loose && body.closing.way == Closing::Way::kCap)
    out += fmt::format(
        ". If it is terrain, a sheet over the whole domain, set \"closing\": {{\"extrude\": \"-{}\"}}: everything below it is then inside",
        axis_name(*axis));
  return out;
}

bool uses_parity(const ClosedBody& closed) {
  return std::ranges::any_of(closed.fill, [](const FillChoice& f) { return f.rule != Fill::kNonzero; });
}

std::string flip_warning(const ClosedBody& closed) {
  if (closed.flips.empty()) return "";
  uint64_t edges = 0;
  for (const Flip& f : closed.flips) edges += f.edges;
  const char* parity =
      "The inside of such a shell is decided by parity, so orientation does not matter. Where the shell overlaps itself it comes out hollow: "
      "orient its facets alike if that is wrong";
  const char* winding =
      "With \"fill\": \"nonzero\" each of these curves is a hole, and was closed by caps. Orient the facets alike, or set \"fill\": \"auto\", which "
      "decides by parity";
  return fmt::format("has facets that face the opposite way from their neighbours, along {} in {}, the first at {}. {}", plural(edges, "edge"),
                     plural(closed.flips.size(), "curve"), place_text(closed.flips[0].at), uses_parity(closed) ? parity : winding);
}

std::string double_warning(const ClosedBody& closed) {
  for (const FillChoice& f : closed.fill)
    if (f.rule == Fill::kDistinct && f.why != "asked for")
      return fmt::format("contains its surface or parts of it twice: {}. Remove one copy if that was not intended", f.why);
  return "";
}

}  // namespace

std::vector<std::string> surface_warnings(const Scene& scene, const SceneBody& body, const BodyFacets& found, const Grid& grid,
                                          const SurfaceCounts& counts) {
  const ClosedBody& closed = found.closed;
  std::vector<std::string> out = {seam_note(scene, closed, grid), open_warning(scene, body, found, grid), flip_warning(closed),
                                  double_warning(closed)};
  const bool evenodd = std::ranges::any_of(closed.fill, [](const FillChoice& f) { return f.rule == Fill::kEvenodd; });
  if (evenodd && counts.duplicates > 0)
    out.push_back(fmt::format(
        "has {}, and shells whose inside is decided by parity. There, two facets with the same vertices count as none: remove the duplicates if they are not intended",
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

}  // namespace teracell::mesher
