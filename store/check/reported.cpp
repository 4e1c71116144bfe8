#include "store/check/reported.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/base/error.hpp"

namespace teracell::inline store {
namespace {

using nlohmann::json;

constexpr double kFlat = 1e-6;  // of a hole's diameter: coordinates of single precision are rounded by as much

std::optional<Vec3> place_in(const json& j, const char* key) {
  const auto at = j.find(key);
  return at == j.end() || at->is_null() ? std::nullopt : std::optional(at->get<Vec3>());
}

const char* plural(uint64_t n, const char* one, const char* many) { return n == 1 ? one : many; }

// Reads the report in one go; the body that was read last is all that it holds.
class Reported {
 public:
  Reported(Findings& findings, const Metadata& meta) : findings_(findings), meta_(meta), units_(meta.units) {}

  void read(const std::string& report) {
    std::string top;  // the key of the outermost object
    json rest = json::parse(report, [&](int depth, json::parse_event_t event, json& value) {
      if (event == json::parse_event_t::key && depth == 1) top = value.get<std::string>();
      if (top == "scene" || top == "inputs" || top == "warnings") return depth < 1 || event == json::parse_event_t::key;
      if (top != "bodies" || depth != 2 || event != json::parse_event_t::object_end) return true;
      body(value);
      return false;
    });
    if (!rest.contains("bodies") && bodies_ == 0)
      return missing("The file has no report of the mesher: what became of the surfaces was not looked at.");
    if (const auto gaps = rest.find("lost_gaps"); gaps != rest.end() && gaps->is_array())
      for (const json& gap : *gaps) lost_gap(gap);
    if (const auto left_out = rest.find("bodies_left_out"); left_out != rest.end())
      missing(fmt::format("The report in the file has no room for {} bodies.", grouped(left_out->get<uint64_t>())));
    if (const auto overlaps = rest.find("overlaps"); overlaps != rest.end() && !overlaps->is_null()) {
      for (const json& pair : overlaps->at("list")) overlap(pair);
      KindTotal& total = findings_.totals[static_cast<size_t>(FindingKind::overlap)];
      total.findings = std::max(total.findings, overlaps->at("pairs").get<uint64_t>());
    } else {
      for (Finding& finding : covered_) add_finding(findings_, std::move(finding));
      if (bodies_ > 1) missing("Overlaps by pair: the file does not have them. What is listed are the cells that each body leaves to stronger ones.");
    }
    if (rays_only_) missing("What is lost between sample points was counted along the rays alone: mesh with --thin to look along x, y and z.");
  }

 private:
  void missing(std::string text) { findings_.not_looked_at.push_back(std::move(text)); }
  std::string length(double x) const { return fmt::format("{:.4g} {}", x, units_); }
  void add(FindingKind kind, FindingLevel level, std::string body, std::optional<Vec3> at, std::string text, CellCount cells = 0) {
    add_finding(findings_, {kind, level, {std::move(body)}, cells, at, std::nullopt, std::move(text)});
  }
  void left_out(FindingKind kind, const json& body, const char* key) {
    findings_.totals[static_cast<size_t>(kind)].findings += body.value(key, uint64_t{0});
  }

  void body(const json& j) {
    ++bodies_;
    const std::string name = j.at("name");
    const bool is_sheet = j.value("kind", "solid") == "sheet";
    const auto cells = j.at("cells").get<double>();
    const auto covered = static_cast<uint64_t>(j.value("covered_cells", 0.0));
    if (cells == 0)
      add(FindingKind::empty, FindingLevel::error, name, std::nullopt,
          covered > 0 ? fmt::format("The body '{}' owns no cell: all {} of its cells belong to stronger bodies.", name, grouped(covered))
                      : fmt::format("The body '{}' has no cell: it lies outside the domain, or between sample points.", name));
    for (const json& flip : j.at("flips")) {
      const auto edges = flip.at("edges").get<uint64_t>();
      add(FindingKind::winding, FindingLevel::warning, name, place_in(flip, "at"),
          fmt::format("Along {} {} of '{}' the facets on both sides face opposite ways.", edges, plural(edges, "edge", "edges"), name));
    }
    left_out(FindingKind::winding, j, "flips_left_out");
    for (const json& hole : j.at("holes")) this->hole(name, hole);
    left_out(FindingKind::cap, j, "holes_left_out");
    if (const auto seams = j.find("seams"); seams != j.end() && seams->at("number").get<uint64_t>() > 0) {
      const auto number = seams->at("number").get<uint64_t>();
      add(FindingKind::seam, FindingLevel::note, name, std::nullopt,
          fmt::format("{} {} of '{}', {} long in all, {} stitched; the widest gap is {}.", grouped(number), plural(number, "seam", "seams"), name,
                      length(seams->at("length").get<double>()), plural(number, "was", "were"), length(seams->at("widest_gap").get<double>())));
    }
    if (covered > 0 && cells > 0)
      covered_.push_back({FindingKind::overlap,
                          FindingLevel::note,
                          {name},
                          covered,
                          std::nullopt,
                          std::nullopt,
                          fmt::format("{} cells in '{}' belong to stronger bodies.", grouped(covered), name)});
    if (!is_sheet) lost(name, j);
  }

  void hole(const std::string& name, const json& j) {
    const auto at = place_in(j, "at");
    if (j.value("extruded", false))
      return add(FindingKind::cap, FindingLevel::note, name, at,
                 fmt::format("An outer loop of '{}' was closed by walls and a floor beyond the domain.", name));
    const double across = j.at("diameter").get<double>(), gap = j.value("width", across), cells = j.value("width_cells", 0.0);
    add_finding(findings_, {FindingKind::cap,
                            cells >= 1 ? FindingLevel::warning : FindingLevel::note,
                            {name},
                            0,
                            at,
                            box_in(j),
                            fmt::format("A hole of '{}', {} long and {} wide{}, was closed by a cap: {}.", name, length(across), length(gap),
                                        cells > 0 ? fmt::format(" ({:.3g} cells)", cells) : "", shape_of_cap(j, across))});
  }

  // How much of a guess a cap is.
  std::string shape_of_cap(const json& j, double across) const {
    const auto off = j.find("off_plane");
    if (off == j.end()) return "the surface there is a guess";
    if (off->get<double>() <= kFlat * across) return "it is flat, as the edge of the hole is";
    return fmt::format("a guess, since the edge of the hole is up to {} ({:.3g} cells) off a plane", length(off->get<double>()),
                       j.value("off_plane_cells", 0.0));
  }

  // The cells that the box of a hole meets; none where it lies outside the grid.
  std::optional<Box> box_in(const json& j) const {
    const auto found = j.find("box");
    if (found == j.end()) return std::nullopt;
    const auto c = found->get<std::array<double, 6>>();
    Box box;
    for (size_t d = 0; d < 3; ++d) {
      const Axis& axis = meta_.grid.axis[d];
      if (!(c[d + 3] >= axis.min() && c[d] <= axis.max())) return std::nullopt;
      box.lo[d] = axis.cell_at(std::max(c[d], axis.min()));
      box.hi[d] = axis.cell_at(std::min(c[d + 3], axis.max())) + 1;
    }
    return box;
  }

  void lost(const std::string& name, const json& j) {
    if (const auto all = j.find("lost"); all != j.end()) {
      for (const auto& [axis, found] : all->items()) {
        const auto number = found.at("number").get<uint64_t>();
        if (number == 0) continue;
        add(FindingKind::lost_stretch, FindingLevel::warning, name, place_in(found, "at"),
            fmt::format("Along {}, no sample point meets {} {} of '{}'; the widest is {}.", axis, grouped(number),
                        plural(number, "stretch", "stretches"), name, length(found.at("widest").get<double>())));
      }
      return;
    }
    rays_only_ = true;
    const auto pairs = j.find("lost_stretches");
    if (pairs == j.end()) return;
    if (const auto number = pairs->at("number").get<uint64_t>(); number > 0)
      add(FindingKind::lost_stretch, FindingLevel::warning, name, place_in(*pairs, "at"),
          fmt::format("Along {}, {} {} of '{}' {} between two sample points: what is there is thinner than a cell.",
                      pairs->at("axis").get<std::string>(), grouped(number), plural(number, "stretch", "stretches"), name,
                      plural(number, "lies", "lie")));
  }

  void lost_gap(const json& j) {
    const auto number = j.at("number").get<uint64_t>();
    if (number == 0) return;
    const std::string material = j.at("material");
    add(FindingKind::lost_gap, FindingLevel::warning, material, place_in(j, "at"),
        fmt::format("Along {}, no sample point meets {} {} in '{}'; the widest is {}.", j.at("axis").get<std::string>(), grouped(number),
                    plural(number, "gap", "gaps"), material, length(j.at("widest").get<double>())));
  }

  void overlap(const json& j) {
    const auto bodies = j.at("bodies").get<std::vector<std::string>>();
    const auto cells = static_cast<uint64_t>(j.at("cells").get<double>());
    const json& owner = j.at("owner");
    const auto b = j.at("box").get<std::array<int64_t, 6>>();
    add_finding(findings_,
                {FindingKind::overlap, FindingLevel::note, bodies, cells, place_in(j, "at"), Box{{b[0], b[1], b[2]}, {b[3], b[4], b[5]}},
                 fmt::format("'{}' and '{}' overlap in {} {}, which {}.", bodies.at(0), bodies.at(1), grouped(cells), plural(cells, "cell", "cells"),
                             owner.is_string() ? fmt::format("'{}' owns", owner.get<std::string>()) : "a third body owns in part")});
  }

  Findings& findings_;
  const Metadata& meta_;
  const std::string& units_;  // as people write them
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

void add_reported(Findings& findings, const std::string& report, const Metadata& meta) try {
  Reported(findings, meta).read(report);
} catch (const json::exception& e) {
  throw FormatError(fmt::format("report: expected what the mesher writes, found something else: {}", e.what()));
}

}  // namespace teracell::store
