// teracell info: what grids, surfaces and assemblies hold.
#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "store/base/error.hpp"
#include "store/channels/fractions.hpp"
#include "store/format/report_json.hpp"
#include "store/grid/number_text.hpp"
#include "store/text/text.hpp"
#include "store/whole/info.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/commands/mesh_summary.hpp"
#include "tools/cli/parts_table.hpp"

namespace teracell::cli {
namespace {

struct InfoArguments {
  std::vector<std::string> files;
  SourceOptions source;
  CadArguments cad;
  bool json = false;
};

void row(const std::string& name, const std::string& text) { say(fmt::format("{:<12}{}", name, text)); }

// Prints a line below a body.
void detail(const std::string& name, const std::string& text) { row("", fmt::format("  {:<12}{}", name, text)); }

// The largest holes of a body.
void print_holes(const std::vector<HoleReport>& holes, const std::string& units) {
  constexpr size_t kShown = 5;
  std::vector<HoleReport> sorted = holes;
  std::ranges::stable_sort(sorted, std::ranges::greater{}, &HoleReport::diameter);
  std::string title = "holes";
  for (size_t i = 0; i < std::min(sorted.size(), kShown); ++i) {
    const HoleReport& h = sorted[i];
    const auto gap = h.width > 0.0 ? fmt::format("gap {} {} ({} cells), ", number_text(*h.width, 4), units, number_text(h.width_cells, 3)) : "";
    detail(std::exchange(title, ""),
           fmt::format("{} {} across ({} cells), {}at {}, {}, {} {} {}²", number_text(h.diameter, 4), units, number_text(h.diameter_cells, 3), gap,
                       place_text(h.at), counted(h.edges, "edge"), h.extruded ? "extruded, floor of" : "cap of", number_text(h.cap_area, 4), units));
  }
  if (sorted.size() > kShown)
    detail("", fmt::format("and {} more, none wider than {} {}", fmt::group_digits(sorted.size() - kShown), number_text(sorted[kShown].diameter, 4),
                           units));
}

void print_seams(const BodyReport& body, const std::string& units) {
  const Seams& seams = body.seams;
  if (seams.number == 0 && seams.collapsed == 0) return;
  detail("seams", fmt::format("{} stitched, {} {} in all{}, over gaps of up to {} {} (stitch length {} {})", counted(seams.number, "seam"),
                              number_text(seams.length, 4), units,
                              seams.collapsed > 0 ? fmt::format(", and {} closed to a point", counted(seams.collapsed, "open edge")) : "",
                              number_text(seams.widest_gap, 3), units, number_text(body.stitch, 3), units));
}

void print_flips(const std::vector<Flip>& flips) {
  constexpr size_t kShown = 3;
  std::string title = "flips";
  for (size_t i = 0; i < std::min(flips.size(), kShown); ++i)
    detail(std::exchange(title, ""),
           fmt::format("neighbours face opposite ways along {} at {}", counted(flips[i].edges, "edge"), place_text(flips[i].at)));
  if (flips.size() > kShown) detail("", fmt::format("and along {}", counted(flips.size() - kShown, "more curve")));
}

void print_rules(const std::vector<FillChoice>& fill) {
  std::string title = "inside";
  for (const FillChoice& f : fill) {
    const char* where = f.rule == Fill::kEvenodd    ? "a ray out passes the surface an odd number of times"
                        : f.rule == Fill::kDistinct ? "a ray out passes an odd number of places, each counted once however many facets lie there"
                                                    : "the surface winds around";
    detail(std::exchange(title, ""),
           fmt::format("of {}: where {} ({}: {})", counted(f.shells.value_or(0), "shell"), where, fill_name(f.rule), f.why));
  }
}

// "12, the widest 0.0312 mm at (...)"
std::string lost_text(const LostReport& lost, const std::string& units) {
  return fmt::format("{}, the widest {} {} at {}", fmt::group_digits(lost.number), number_text(lost.widest, 4), units,
                     place_text(lost.at.value_or(Vec3{})));
}

// Prints which parts of a body lie between sample points. Files of version 1.0 may say nothing about that.
void print_lost(const BodyReport& b, const std::string& units) {
  std::string title = "thin parts";
  if (b.lost_pairs > 0)
    detail(std::exchange(title, ""),
           fmt::format("rays along {} cross it twice between two sample points in {}, the first at {}", axis_name(b.lost_axis),
                       counted(b.lost_pairs, "place"), place_text(b.first_lost_pair.value_or(Vec3{}))));
  if (!b.lost) return;
  for (int axis = 0; axis < 3; ++axis)
    if (const LostReport& lost = (*b.lost)[axis]; lost.number > 0)
      detail(std::exchange(title, ""), fmt::format("stretches between two sample points along {}: {}", axis_name(axis), lost_text(lost, units)));
}

// Prints a body in one line, and below it whatever is not as it should be.
void print_body(const std::string& title, const BodyReport& b, const std::string& units) {
  std::vector<std::string_view> rules;
  for (const FillChoice& f : b.fill) rules.push_back(fill_name(f.rule));
  const bool parity = std::ranges::any_of(b.fill, [](const FillChoice& f) { return f.rule != Fill::kNonzero; });
  row(title, fmt::format("{}: {} in {}, {}, {}", b.name, counted(b.facets, "facet"), counted(b.counts.shells, "shell"),
                         b.sheet ? "sheet" : fmt::format("{}", fmt::join(rules, " and ")), counted(b.cells, "cell")));
  if (parity || !b.holes.empty() || !b.flips.empty()) print_rules(b.fill);
  print_seams(b, units);
  print_holes(b.holes, units);
  print_flips(b.flips);
  print_lost(b, units);
  if (b.covered > 0) detail("overlap", counted(b.covered, "cell") + ", owned by stronger bodies");
  if (const uint64_t n = b.counts.duplicates; n > 0)
    detail("duplicates", fmt::format("{} with the vertices of an earlier one: {} the same way round, {} the other way", counted(n, "facet"),
                                     fmt::group_digits(n - b.counts.opposite), fmt::group_digits(b.counts.opposite)));
  if (b.counts.degenerate > 0)
    detail("degenerate", fmt::format("{} without area: they change nothing, as no ray crosses them", counted(b.counts.degenerate, "facet")));
}

// What the CAD kernel, the facets, the sender and the grid say of the volume of a body, as far as each of them knows.
void print_volumes(const CadReport& cad, const std::string& units) {
  double facets = 0;
  std::optional<double> kernel = 0, sender = 0;
  uint64_t without = 0, faces = 0;
  const auto add = [](std::optional<double>& sum, const std::optional<double>& v, uint64_t times) {
    sum = sum && v ? std::optional(*sum + *v * static_cast<double>(times)) : std::nullopt;
  };
  for (const CadPartReport& p : cad.parts) {
    facets += p.facet_volume * static_cast<double>(p.instances);
    add(kernel, p.kernel_volume, p.instances), add(sender, p.sender_volume, p.instances);
    without += p.instances * p.faces_without_facets, faces += p.instances * p.faces;
  }
  if (cad.parts_left_out == 0) {
    const auto text = [&](const std::optional<double>& v) { return v ? number_text(*v, 6) : "-"; };
    detail("volumes", fmt::format("CAD kernel {}, facets {}, sender {}, grid {}{} {}³", text(kernel), text(facets), text(sender),
                                  text(cad.grid_volume), cad.by_shares ? " by shares" : "", units));
  }
  detail("facets of", fmt::format("{} by {}, within {} {} and {}°", counted(faces, "face"), cad.kernel, number_text(cad.deflection, 3), units,
                                  number_text(cad.angle, 3)));
  if (without > 0) detail("", fmt::format("none of {} of these", counted(without, "face")));
}

void print_breaches(const PlanesReport& planes, const std::string& units) {
  std::string title = "planes";
  for (const std::string& line : breach_lines(planes, units)) row(std::exchange(title, ""), line);
}

void print_report(const Report& report, const std::string& units) {
  std::string title = "bodies";
  for (size_t i = 0; i < report.bodies.size(); ++i) {
    print_body(std::exchange(title, ""), report.bodies[i], units);
    if (i < report.inputs.size() && report.inputs[i].cad) print_volumes(*report.inputs[i].cad, units);
  }
  if (const std::string overlaps = overlaps_text(report); !overlaps.empty()) row("overlaps", overlaps);
  title = "gaps";
  if (report.planes) print_breaches(*report.planes, units);
  if (report.lost_gaps)
    for (const GapReport& gap : *report.lost_gaps)
      row(std::exchange(title, ""),
          fmt::format("of {} between two sample points along {}: {}", gap.material, axis_name(gap.axis), lost_text(gap.lost, units)));
  if (report.bodies_left_out > 0) row("", fmt::format("and {} more bodies, too many for the report", fmt::group_digits(report.bodies_left_out)));
  title = "warnings";
  for (const std::string& w : report.warnings) row(std::exchange(title, ""), w);
}

// The largest patches of the surfaces; the sides of the domain say nothing new.
void print_patches(const Metadata& meta) {
  constexpr size_t kShown = 12;
  std::vector<const PatchInfo*> patches;
  size_t width = 0;
  for (const PatchInfo& p : meta.patches)
    if (!p.body.empty()) patches.push_back(&p);
  std::ranges::stable_sort(patches, std::ranges::greater{}, &PatchInfo::area);
  const size_t shown = std::min(patches.size(), kShown);
  for (size_t i = 0; i < shown; ++i) width = std::max(width, patches[i]->name.size());
  std::string title = "patches";
  for (size_t i = 0; i < shown; ++i)
    row(std::exchange(title, ""), fmt::format("{:<{}}  {} {}²", patches[i]->name, width, number_text(patches[i]->area, 4), meta.units));
  if (patches.size() > shown)
    row("", fmt::format("and {} more, none larger than {} {}²", fmt::group_digits(patches.size() - shown), number_text(patches[shown]->area, 4),
                        meta.units));
}

// What the file holds beside the cells.
void print_channels(const Metadata& meta) {
  std::string title = "channels";
  for (const Channel& c : meta.others()) {
    std::string about;
    if (const Channel* fractions = find_fractions(meta); fractions == &c) {
      const Subdivision s = subdivision_of(c);
      about = fmt::format(", {} x {} x {} sub-samples of each mixed cell", s[0], s[1], s[2]);
    }
    row(std::exchange(title, ""), fmt::format("{}  {}{}", c.name, c.bytes > 0 ? bytes_text(static_cast<double>(c.bytes)) : "of unknown size", about));
  }
}

void print(const GridReader& reader) {
  const Metadata& meta = reader.meta();
  const Index3 n = meta.grid.cells();
  const double cells = static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]);
  const auto size = static_cast<double>(reader.file_bytes());
  row("file", fmt::format("{}, {}, content {}", reader.name(), bytes_text(size), reader.hash()));
  if (!meta.labels_hash.empty()) row("hash", meta.labels_hash + " of the cells, however they are stored");
  row("cells", cells_text(n) + (cells < 1e9 ? "" : fmt::format(" ({})", number_text(cells, 3))));
  for (int d = 0; d < 3; ++d) {
    const Axis& a = meta.grid.axis[d];
    row(d == 0 ? "domain" : "", axis_text(d, a, meta.units));
  }
  row("rays", fmt::format("along {}, {} facet crossings, {:.2f} bits per crossing on level 0", axis_name(meta.ray_axis),
                          fmt::group_digits(meta.crossings), bits_per_crossing(meta)));
  row("dense",
      fmt::format(
          "one byte per cell would take {}{}", bytes_text(cells),
          cells < size ? "" : fmt::format(", {} times as much", fmt::group_digits(static_cast<unsigned __int128>(std::round(cells / size))))));
  size_t width = 0;
  for (const MaterialInfo& m : meta.materials) width = std::max(width, m.name.size());
  for (size_t i = 0; i < meta.materials.size(); ++i)
    row(i == 0 ? "materials" : "", fmt::format("{:>3}  {:<{}}  {}", i, meta.materials[i].name, width, meta.materials[i].color));
  print_patches(meta);
  for (int level = 0; level < reader.levels(); ++level) {
    std::string how = "derived when read";
    for (const LevelInfo& l : meta.levels())
      if (l.level == level)
        how = fmt::format("{:>9} {:<6} {:>10}", fmt::group_digits(l.chunks), l.chunks == 1 ? "chunk" : "chunks", bytes_text(l.bytes));
    row(level == 0 ? "levels" : "", fmt::format("{:>3}  {:<24} {}", level, size_text(meta.grid.cells(level)), how));
  }
  print_channels(meta);
  const std::string report = reader.report();
  try {
    print_report(parse_report(report), meta.units);
  } catch (const FormatError&) {
    row("report", "is not laid out as this program lays it out");
  }
}

void run(const InfoArguments& o) {
  std::vector<std::string> surfaces;
  for (const std::string& name : o.files)
    if (!names_a_grid(name)) surfaces.push_back(name);
  if (!surfaces.empty() && surfaces.size() < o.files.size())
    throw UsageError("expected grids or surfaces, found both: ask for them one after another");
  if (!surfaces.empty()) return print_surfaces(surfaces, o.json, o.cad.options());
  for (const std::string& name : o.files) {
    const GridReader reader = open_grid({name, o.source});
    if (o.json) std::cout << info_json(reader) << "\n";
    else print(reader);
  }
}

}  // namespace

Run setup_info(CLI::App& app) {
  const auto o = std::make_shared<InfoArguments>();
  app.add_option("files", o->files, "grids, or surfaces and assemblies: .tcell files, addresses of grids, STL, OBJ, PLY, OFF, 3MF, glTF, STEP")
      ->required()
      ->type_name("FILE");
  add_source_options(app, o->source);
  app.add_flag("--json", o->json, "as JSON");
  add_cad_limits(app, o->cad);
  app.footer("Examples:\n  teracell info g.tcell\n  teracell info assembly.3mf");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
