#include "mesher/report/make_report.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "mesher/report/warnings.hpp"
#include "store/channels/fractions.hpp"

namespace teracell::mesher {
namespace {

using What = TallyKey::What;

HoleReport hole_report(const Hole& h, const Grid& grid) {
  return {.at = h.at,
          .edges = h.edges,
          .diameter = h.diameter,
          .cap_area = h.cap_area,
          .diameter_cells = in_cells(h.diameter, h.at, grid),
          .extruded = h.extruded,
          .width = h.width,
          .off_plane = h.off_plane,
          .width_cells = in_cells(h.width, h.at, grid),
          .off_plane_cells = in_cells(h.off_plane, h.at, grid),
          .box = {{h.lo[0], h.lo[1], h.lo[2], h.hi[0], h.hi[1], h.hi[2]}}};
}

LostReport lost_report(const TallyKey& key, const Grid& grid, const Tallies& tallies) {
  const Tally* found = tallies.find(key);
  if (!found) return {};
  return {found->number, found->widest, found->length, place_of(key, *found, grid)};
}

BodyReport body_report(const Scene& scene, size_t b, BodyFacets&& found, const SurfaceCounts& counts, const Plan& plan, const CastTotals& totals,
                       bool count_thin) {
  const SceneBody& body = scene.bodies[b];
  const Grid& grid = plan.meta.grid;
  ClosedBody& closed = found.closed;
  BodyReport out;
  out.name = body.name;
  out.sheet = body.kind == Kind::kSheet;
  out.facets = found.file.facets;
  out.counts = counts;
  out.fill = std::move(closed.fill);
  out.stitch = closed.stitch;
  out.seams = closed.seams;
  for (const Hole& h : closed.holes) out.holes.push_back(hole_report(h, grid));
  out.flips = std::move(closed.flips);
  out.cells = totals.cells[b];
  out.covered = totals.covered[b];
  const auto key = [&](What what, int axis) { return TallyKey{what, static_cast<uint32_t>(b), static_cast<uint8_t>(axis)}; };
  const LostReport pairs = lost_report(key(What::kPairs, plan.rays.axis), grid, totals.tallies);
  out.lost_axis = plan.rays.axis;
  out.lost_pairs = pairs.number;
  out.first_lost_pair = pairs.at;
  if (ThinParts::wanted(body, count_thin)) {
    out.lost.emplace();
    for (int axis = 0; axis < 3; ++axis) (*out.lost)[axis] = lost_report(key(What::kStretches, axis), grid, totals.tallies);
  }
  return out;
}

// Where the body's matrix puts the parts.
CadReport cad_report(const SceneBody& body, const SurfaceFile& file, size_t& parts_left) {
  const double volume = std::abs(determinant(body.matrix));
  CadReport out{
      file.cad->kernel, file.cad->key, file.cad->hash, file.cad->deflection * longest_column(body.matrix), file.cad->angle, {}, 0, {}, false};
  for (const CadPart& p : file.cad_parts) {
    if (parts_left == 0) {
      ++out.parts_left_out;
      continue;
    }
    --parts_left;
    CadPartReport& part =
        out.parts.emplace_back(CadPartReport{p.path, p.instances, p.shape.faces, p.shape.faces_without_facets, p.shape.closed,
                                             std::abs(p.shape.facet_volume) * volume, p.shape.kernel_volume, p.shape.sender_volume});
    for (std::optional<double>* v : {&part.kernel_volume, &part.sender_volume})
      if (*v) **v *= volume;
  }
  return out;
}

void put_grid_volume(CadReport& cad, size_t b, const Plan& plan, const CastTotals& totals) {
  double cell = 1;
  for (const Axis& axis : plan.meta.grid.axis) {
    if (axis.is_graded()) return;
    cell *= axis.step();
  }
  double cells = static_cast<double>(totals.cells[b]);
  const std::set<Label> labels = {plan.labels.of_body[b], plan.labels.of_overlap[b]};
  const Channel* fractions = find_fractions(plan.meta);
  cad.by_shares = fractions && std::ranges::count(plan.labels.of_body, plan.labels.of_body[b]) == 1;
  for (const Label label : labels)
    if (const auto more = totals.shares.find(label); cad.by_shares && more != totals.shares.end())
      cells += static_cast<double>(more->second) / sub_samples(subdivision_of(*fractions));
  cad.grid_volume = cells * cell;
}

std::vector<std::string> all_warnings(const Scene& scene, const Bodies& bodies, const std::vector<SurfaceCounts>& counts, const Plan& plan,
                                      const CastTotals& totals) {
  constexpr size_t kMostBytes = size_t{1} << 20;
  std::vector<std::string> out;
  uint64_t more = 0, bytes = 0;
  const auto warn = [&](std::string words) {
    bytes += words.size();
    if (bytes > kMostBytes) ++more;
    else out.push_back(std::move(words));
  };
  std::set<std::array<std::string, 3>> said;  // of a file: once, however many bodies are in it; a merge does not know its folder
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    const SceneBody& body = scene.bodies[b];
    for (const std::string& w : bodies.bodies[b].file.warnings)
      if (said.insert({body.mesh_text, bodies.bodies[b].file.hash, w}).second) warn(fmt::format("{}: {}", body.mesh_text, w));
    for (const std::string& words : surface_warnings(scene, body, bodies.bodies[b], plan.meta.grid, counts[b]))
      warn(fmt::format("body '{}' {}", body.name, words));
  }
  if (plan.planes)
    for (const std::string& words : plan.planes->warnings) warn(words);
  for (const std::string& words : cell_warnings(scene, bodies, plan, totals)) warn(words);
  if (!plan.all_patches && plan.meta.patches.size() == 6)
    warn(fmt::format("no patch of the surfaces is known: the bodies are more than a file has room for, {} patches or {} bytes of names", kMostPatches,
                     kMostPatchNames));
  else if (!plan.all_patches)
    warn(
        fmt::format("a file has room for {} patches and {} bytes of their names: groups and solids beyond that belong to the patches of their bodies "
                    "(a body with \"patches\": false has one)",
                    kMostPatches, kMostPatchNames));
  if (more > 0) out.push_back(fmt::format("there are {} more warnings than the report holds", more));
  return out;
}

std::vector<GapReport> gap_reports(const Scene& scene, const Grid& grid, const Tallies& tallies) {
  std::vector<GapReport> out;
  for (const auto& [key, tally] : tallies.all())
    if (key.what == What::kGaps) out.push_back({scene.materials[key.of].name, key.axis, lost_report(key, grid, tallies)});
  return out;
}

OverlapsReport overlaps_report(const Scene& scene, const Grid& grid, const OverlapSum& sum) {
  constexpr size_t kMost = 1000;
  const auto before = [](const Overlap& a, const Overlap& b) { return a.cells != b.cells ? a.cells > b.cells : a.bodies < b.bodies; };
  OverlapsReport out;
  std::vector<Overlap> most;  // a heap whose front comes last
  sum.for_each([&](const Overlap& o) {
    ++out.pairs;
    most.push_back(o);
    std::ranges::push_heap(most, before);
    if (most.size() <= kMost) return;
    std::ranges::pop_heap(most, before);
    most.pop_back();
  });
  std::ranges::sort_heap(most, before);
  for (const Overlap& o : most) {
    const auto [a, b] = o.bodies;
    OverlapReport& r = out.list.emplace_back();
    r.bodies = {scene.bodies[a].name, scene.bodies[b].name};
    r.cells = o.cells;
    if (!o.third) r.owner = scene.bodies[is_stronger(scene, a, b) ? a : b].name;
    r.box = o.box;
    for (int d = 0; d < 3; ++d) r.at[d] = grid.axis[d].centre(o.at[d]);
  }
  return out;
}

}  // namespace

Report make_report(const Scene& scene, Bodies&& bodies, const std::vector<SurfaceCounts>& counts, const Plan& plan, const CastTotals& totals,
                   bool count_thin) {
  Report out;
  out.crossings = totals.crossings;
  out.warnings = all_warnings(scene, bodies, counts, plan, totals);
  out.axis = plan.rays.axis;
  out.axis_asked_for = plan.rays.asked_for;
  out.crossings_expected = plan.rays.crossings;
  size_t parts_left = 10'000;  // in the report
  for (size_t b = 0; b < scene.bodies.size(); ++b) {
    BodyFacets& found = bodies.bodies[b];
    out.inputs.push_back({scene.bodies[b].mesh_text, found.file.format, found.file.hash, found.file.bytes, found.file.unit, found.file.factor.value(),
                          found.file.cad ? std::optional(cad_report(scene.bodies[b], found.file, parts_left)) : std::nullopt});
    if (out.inputs.back().cad) put_grid_volume(*out.inputs.back().cad, b, plan, totals);
    out.bodies.push_back(body_report(scene, b, std::move(found), counts[b], plan, totals, count_thin));
  }
  bodies.bodies = {};
  out.planes = plan.planes;
  out.overlaps = overlaps_report(scene, plan.meta.grid, totals.overlaps);
  if (count_thin) out.lost_gaps = gap_reports(scene, plan.meta.grid, totals.tallies);
  return out;
}

}  // namespace teracell::mesher
