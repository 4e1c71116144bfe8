#include "store/check/reported.hpp"

#include <algorithm>
#include <unordered_set>

#include <fmt/format.h>

#include "store/format/report_json.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

constexpr double kFlat = 1e-6;  // of a hole's diameter: coordinates of single precision are rounded by as much

// Turns the report into findings, body by body.
class Reported {
 public:
  Reported(Findings& findings, const Metadata& meta) : findings_(findings), meta_(meta), units_(meta.units) {}

  void body(const BodyReport& b) {
    ++bodies_;
    if (b.cells == 0)
      add(FindingKind::empty, FindingLevel::error, b.name, std::nullopt,
          b.covered > 0
              ? fmt::format("The body '{}' owns no cell: all {} of its cells belong to stronger bodies.", b.name, fmt::group_digits(b.covered))
              : fmt::format("The body '{}' has no cell: it lies outside the domain, or between sample points.", b.name));
    for (const Flip& flip : b.flips)
      add(FindingKind::winding, FindingLevel::warning, b.name, flip.at,
          fmt::format("Along {} of '{}' the facets on both sides face opposite ways.", counted(flip.edges, "edge"), b.name));
    total(FindingKind::winding).findings += b.flips_left_out;
    for (const HoleReport& h : b.holes) hole(b.name, h);
    total(FindingKind::cap).findings += b.holes_left_out;
    if (const uint64_t number = b.seams.number; number > 0)
      add(FindingKind::seam, FindingLevel::note, b.name, std::nullopt,
          fmt::format("{} of '{}', {} long in all, {} stitched; the widest gap is {}.", counted(number, "seam"), b.name, length(b.seams.length),
                      number == 1 ? "was" : "were", length(b.seams.widest_gap)));
    if (b.covered > 0 && b.cells > 0)
      covered_.push_back({FindingKind::overlap,
                          FindingLevel::note,
                          {b.name},
                          b.covered,
                          std::nullopt,
                          std::nullopt,
                          fmt::format("{} cells in '{}' belong to stronger bodies.", fmt::group_digits(b.covered), b.name)});
    if (b.sheet) sheets_.insert(b.name);
    else lost(b);
  }

  void rest(const Report& report) {
    if (report.lost_gaps)
      for (const GapReport& gap : *report.lost_gaps) lost_gap(gap);
    if (report.bodies_left_out > 0)
      missing(fmt::format("The report in the file has no room for {} bodies.", fmt::group_digits(report.bodies_left_out)));
    if (report.overlaps) {
      for (const OverlapReport& pair : report.overlaps->list) overlap(pair);
      uint64_t& pairs = total(FindingKind::overlap).findings;
      pairs = std::max(pairs, report.overlaps->pairs);
    } else {
      for (Finding& finding : covered_) add_finding(findings_, std::move(finding));
      if (bodies_ > 1) missing("Overlaps by pair: the file does not have them. What is listed are the cells that each body leaves to stronger ones.");
    }
    if (rays_only_) missing("What is lost between sample points was counted along the rays alone: mesh with --thin to look along x, y and z.");
  }

  std::vector<bool> sheets(const std::vector<std::string>& materials) const {
    std::vector<bool> out;
    for (const LabelInfo& label : meta_.labels)
      out.push_back(label.body.empty() ? std::ranges::binary_search(materials, meta_.materials[label.material].name) : sheets_.contains(label.body));
    return out;
  }

  void missing(std::string text) { findings_.not_looked_at.push_back(std::move(text)); }

 private:
  std::string length(double x) const { return fmt::format("{:.4g} {}", x, units_); }
  KindTotal& total(FindingKind kind) { return findings_.totals[static_cast<size_t>(kind)]; }
  void add(FindingKind kind, FindingLevel level, std::string body, std::optional<Vec3> at, std::string text) {
    add_finding(findings_, {kind, level, {std::move(body)}, 0, at, std::nullopt, std::move(text)});
  }

  void hole(const std::string& name, const HoleReport& h) {
    if (h.extruded)
      return add(FindingKind::cap, FindingLevel::note, name, h.at,
                 fmt::format("An outer loop of '{}' was closed by walls and a floor beyond the domain.", name));
    add_finding(findings_, {FindingKind::cap,
                            h.width_cells >= 1 ? FindingLevel::warning : FindingLevel::note,
                            {name},
                            0,
                            h.at,
                            h.box ? cells_in(*h.box) : std::nullopt,
                            fmt::format("A hole of '{}', {} long and {} wide{}, was closed by a cap: {}.", name, length(h.diameter),
                                        length(h.width.value_or(h.diameter)), h.width_cells > 0 ? fmt::format(" ({:.3g} cells)", h.width_cells) : "",
                                        shape_of_cap(h))});
  }

  // How much of a guess a cap is.
  std::string shape_of_cap(const HoleReport& h) const {
    if (!h.off_plane) return "the surface there is a guess";
    if (*h.off_plane <= kFlat * h.diameter) return "it is flat, as the edge of the hole is";
    return fmt::format("a guess, since the edge of the hole is up to {} ({:.3g} cells) off a plane", length(*h.off_plane), h.off_plane_cells);
  }

  // The cells that a box meets; none where it lies outside the grid.
  std::optional<Box> cells_in(const std::array<double, 6>& c) const {
    Box box;
    for (size_t d = 0; d < 3; ++d) {
      const Axis& axis = meta_.grid.axis[d];
      if (!(c[d + 3] >= axis.min() && c[d] <= axis.max())) return std::nullopt;
      box.lo[d] = axis.cell_at(std::max(c[d], axis.min()));
      box.hi[d] = axis.cell_at(std::min(c[d + 3], axis.max())) + 1;
    }
    return box;
  }

  void lost(const BodyReport& b) {
    if (b.lost) {
      for (int axis = 0; axis < 3; ++axis) {
        const LostReport& found = (*b.lost)[static_cast<size_t>(axis)];
        if (found.number > 0)
          add(FindingKind::lost_stretch, FindingLevel::warning, b.name, found.at,
              fmt::format("Along {}, no sample point meets {} of '{}'; the widest is {}.", axis_name(axis),
                          counted(found.number, "stretch", "stretches"), b.name, length(found.widest)));
      }
      return;
    }
    rays_only_ = true;
    if (const uint64_t number = b.lost_pairs; number > 0)
      add(FindingKind::lost_stretch, FindingLevel::warning, b.name, b.first_lost_pair,
          fmt::format("Along {}, {} of '{}' {} between two sample points: what is there is thinner than a cell.", axis_name(b.lost_axis),
                      counted(number, "stretch", "stretches"), b.name, number == 1 ? "lies" : "lie"));
  }

  void lost_gap(const GapReport& gap) {
    if (gap.lost.number == 0) return;
    add(FindingKind::lost_gap, FindingLevel::warning, gap.material, gap.lost.at,
        fmt::format("Along {}, no sample point meets {} in '{}'; the widest is {}.", axis_name(gap.axis), counted(gap.lost.number, "gap"),
                    gap.material, length(gap.lost.widest)));
  }

  void overlap(const OverlapReport& o) {
    const auto& [a, b] = o.bodies;
    add_finding(findings_, {FindingKind::overlap,
                            FindingLevel::note,
                            {a, b},
                            o.cells,
                            o.at,
                            o.box,
                            fmt::format("'{}' and '{}' overlap in {}, which {}.", a, b, counted(o.cells, "cell"),
                                        o.owner ? fmt::format("'{}' owns", *o.owner) : "a third body owns in part")});
  }

  Findings& findings_;
  const Metadata& meta_;
  const std::string& units_;  // as people write them
  std::unordered_set<std::string> sheets_;
  std::vector<Finding> covered_;  // where the file has no overlaps by pair
  uint64_t bodies_ = 0;
  bool rays_only_ = false;
};

}  // namespace

void add_finding(Findings& findings, Finding finding) {
  KindTotal& total = findings.totals[static_cast<size_t>(finding.kind)];
  ++total.findings;
  total.cells += finding.cells;
  if (total.findings <= kMostFindings) findings.list.push_back(std::move(finding));
}

std::vector<bool> add_reported(Findings& findings, const std::string& report, const Metadata& meta) {
  Reported reported(findings, meta);
  const auto rest = read_report(report, [&](const BodyReport& body) { reported.body(body); });
  if (rest) reported.rest(*rest);
  else reported.missing("The file has no report of the mesher: what became of the surfaces was not looked at.");
  return reported.sheets(rest ? rest->sheet_materials : std::vector<std::string>());
}

}  // namespace teracell::store
