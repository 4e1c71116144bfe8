// teracell info: what a file holds.
#include <algorithm>
#include <iostream>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "store/error.hpp"
#include "store/info.hpp"
#include "store/json_text.hpp"
#include "store/text.hpp"
#include "tools/cli/command.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

struct Options {
  std::string grid;
  bool json = false;
};

void row(const std::string& name, const std::string& text) { say(fmt::format("{:<12}{}", name, text)); }

// Prints a line below a body.
void detail(const std::string& name, const std::string& text) { row("", fmt::format("  {:<12}{}", name, text)); }

std::string place(const ordered_json& at) {
  return fmt::format("({:.6g}, {:.6g}, {:.6g})", at.at(0).get<double>(), at.at(1).get<double>(), at.at(2).get<double>());
}

// The largest holes of a body.
void print_holes(const ordered_json& holes, const std::string& units) {
  constexpr size_t kShown = 5;
  const auto diameter = [](const ordered_json* h) { return h->at("diameter").get<double>(); };
  std::vector<const ordered_json*> sorted;
  for (const auto& h : holes) sorted.push_back(&h);
  std::ranges::stable_sort(sorted, std::ranges::greater{}, diameter);
  std::string title = "holes";
  for (size_t i = 0; i < std::min(sorted.size(), kShown); ++i) {
    const ordered_json& h = *sorted[i];
    const auto gap = h.contains("width") ? fmt::format("gap {:.4g} {} ({:.3g} cells), ", h.at("width").get<double>(), units, h.at("width_cells").get<double>()) : "";
    detail(std::exchange(title, ""), fmt::format("{:.4g} {} across ({:.3g} cells), {}at {}, {}, {} {:.4g} {}^2", diameter(&h), units,
                                                 h.at("diameter_cells").get<double>(), gap, place(h.at("at")), plural(h.at("edges").get<uint64_t>(), "edge"),
                                                 h.value("extruded", false) ? "extruded, floor of" : "cap of", h.at("cap_area").get<double>(), units));
  }
  if (sorted.size() > kShown)
    detail("", fmt::format("and {} more, none wider than {:.4g} {}", sorted.size() - kShown, diameter(sorted[kShown]), units));
}

void print_seams(const ordered_json& body, const std::string& units) {
  if (!body.contains("seams")) return;
  const ordered_json& seams = body.at("seams");
  const uint64_t collapsed = seams.value("collapsed_edges", uint64_t{0});
  if (seams.at("number") == 0 && collapsed == 0) return;
  detail("seams", fmt::format("{} stitched, {:.4g} {} in all{}, over gaps of up to {:.3g} {} (stitch length {:.3g} {})",
                              plural(seams.at("number").get<uint64_t>(), "seam"), seams.at("length").get<double>(), units,
                              collapsed > 0 ? fmt::format(", and {} closed to a point", plural(collapsed, "open edge")) : "",
                              seams.at("widest_gap").get<double>(), units, body.at("stitch").get<double>(), units));
}

void print_flips(const ordered_json& flips) {
  constexpr size_t kShown = 3;
  std::string title = "flips";
  for (size_t i = 0; i < std::min(flips.size(), kShown); ++i) {
    const std::string edges = plural(flips[i].at("edges").get<uint64_t>(), "edge");
    detail(std::exchange(title, ""), fmt::format("neighbours face opposite ways along {} at {}", edges, place(flips[i].at("at"))));
  }
  if (flips.size() > kShown) detail("", fmt::format("and along {}", plural(flips.size() - kShown, "more curve")));
}

void print_rules(const ordered_json& fill) {
  std::string title = "inside";
  for (const auto& f : fill) {
    const std::string rule = f.at("rule"), why = f.at("why"), shells = plural(f.at("shells").get<uint64_t>(), "shell");
    const char* where = rule == "evenodd"    ? "a ray out passes the surface an odd number of times"
                        : rule == "distinct" ? "a ray out passes an odd number of places, each counted once however many facets lie there"
                                             : "the surface winds around";
    detail(std::exchange(title, ""), fmt::format("of {}: where {} ({}: {})", shells, where, rule, why));
  }
}

// "12, the widest 0.0312 mm at (...)"
std::string lost_text(const ordered_json& lost, const std::string& units) {
  return fmt::format("{}, the widest {:.4g} {} at {}", lost.at("number").get<uint64_t>(), lost.at("widest").get<double>(), units, place(lost.at("at")));
}

// Prints which parts of a body lie between sample points. Files of version 1.0 may say nothing about that.
void print_lost(const ordered_json& b, const std::string& units) {
  const ordered_json pairs = b.value("lost_stretches", ordered_json{{"number", 0}}), lost = b.value("lost", ordered_json::object());
  std::string title = "thin parts";
  if (const uint64_t n = pairs.at("number").get<uint64_t>(); n > 0)
    detail(std::exchange(title, ""), fmt::format("rays along {} cross it twice between two sample points in {}, the first at {}", pairs.at("axis").get<std::string>(),
                                                 plural(n, "place"), place(pairs.at("at"))));
  for (const auto& [axis, l] : lost.items())
    if (l.at("number") > 0) detail(std::exchange(title, ""), fmt::format("stretches between two sample points along {}: {}", axis, lost_text(l, units)));
}

// Prints a body in one line, and below it whatever is not as it should be.
void print_body(const std::string& title, const ordered_json& b, const std::string& units) {
  const ordered_json &fill = b.at("fill"), &holes = b.at("holes"), &flips = b.at("flips");
  const auto count = [&](const char* key) { return b.at(key).get<uint64_t>(); };
  std::vector<std::string> rules;
  for (const auto& f : fill) rules.push_back(f.at("rule"));
  const bool evenodd = std::ranges::count(rules, "evenodd") > 0, distinct = std::ranges::count(rules, "distinct") > 0;
  const std::string cells = b.contains("cells_text") ? b.at("cells_text").get<std::string>() : b.at("cells").dump();
  row(title, fmt::format("{}: {} in {}, {}, {} cell{}", b.at("name").get<std::string>(), plural(count("facets"), "facet"),
                         plural(count("shells"), "shell"), b.value("kind", fmt::format("{}", fmt::join(rules, " and "))), cells, cells == "1" ? "" : "s"));
  if (evenodd || distinct || !holes.empty() || !flips.empty()) print_rules(fill);
  print_seams(b, units);
  print_holes(holes, units);
  print_flips(flips);
  print_lost(b, units);
  if (b.contains("covered_cells"))
    detail("overlap", fmt::format("{}, owned by stronger bodies", plural(count("covered_cells"), "cell")));
  if (const uint64_t n = count("duplicates"); n > 0) {
    const uint64_t opposite = b.value("opposite", uint64_t{0});
    detail("duplicates", fmt::format("{} with the vertices of an earlier one: {} the same way round, {} the other way", plural(n, "facet"), n - opposite, opposite));
  }
  if (const uint64_t n = count("degenerate"); n > 0)
    detail("degenerate", fmt::format("{} without area: they change nothing, as no ray crosses them", plural(n, "facet")));
}

void print_report(const ordered_json& report, const std::string& units) {
  std::string title = "bodies";
  for (const auto& b : report.value("bodies", ordered_json::array())) print_body(std::exchange(title, ""), b, units);
  title = "gaps";
  for (const auto& gap : report.value("lost_gaps", ordered_json::array()))
    row(std::exchange(title, ""), fmt::format("of {} between two sample points along {}: {}", gap.at("material").get<std::string>(), gap.at("axis").get<std::string>(), lost_text(gap, units)));
  if (const auto n = report.value("bodies_left_out", uint64_t{0}); n > 0) row("", fmt::format("and {} more bodies, too many for the report", n));
  title = "warnings";
  for (const auto& w : report.value("warnings", ordered_json::array())) row(std::exchange(title, ""), w.get<std::string>());
}

void print(const GridReader& reader) {
  const Metadata& meta = reader.meta();
  const Index3 n = meta.grid.cells();
  const double cells = static_cast<double>(n[0]) * static_cast<double>(n[1]) * static_cast<double>(n[2]);
  const auto size = static_cast<double>(reader.file_bytes());
  row("file", fmt::format("{}, {}, content {}", reader.name(), bytes_text(size), reader.hash()));
  row("cells", fmt::format("{} x {} x {} = {}{}", n[0], n[1], n[2], cell_count_text(n), cells < 1e6 ? "" : fmt::format(" ({:.3g})", cells)));
  for (int d = 0; d < 3; ++d) {
    const Axis& a = meta.grid.axis[d];
    row(d == 0 ? "domain" : "", fmt::format("{}  {:.8g} to {:.8g} {}, {}", axis_name(d), a.min(), a.max(), meta.units,
                                             a.is_graded() ? "graded" : fmt::format("cells of {:.6g} {}", a.step(), meta.units)));
  }
  row("rays", fmt::format("along {}, {} facet crossings, {:.2f} bits per crossing on level 0", axis_name(meta.ray_axis), meta.crossings,
                          bits_per_crossing(meta)));
  row("dense", fmt::format("one byte per cell would take {}{}", bytes_text(cells),
                           cells < size ? "" : fmt::format(", {:.0f} times as much", cells / size)));
  size_t width = 0;
  for (const MaterialInfo& m : meta.materials) width = std::max(width, m.name.size());
  for (size_t i = 0; i < meta.materials.size(); ++i)
    row(i == 0 ? "materials" : "", fmt::format("{:>3}  {:<{}}  {}", i, meta.materials[i].name, width, meta.materials[i].color));
  for (int level = 0; level < reader.levels(); ++level) {
    const Index3 c = meta.grid.cells(level);
    std::string how = "derived when read";
    for (const LevelInfo& l : meta.levels)
      if (l.level == level) how = fmt::format("{:>9} {:<6} {:>10}", l.chunks, l.chunks == 1 ? "chunk" : "chunks", bytes_text(l.bytes));
    row(level == 0 ? "levels" : "", fmt::format("{:>3}  {:<24} {}", level, fmt::format("{} x {} x {}", c[0], c[1], c[2]), how));
  }
  const std::string report = reader.report();
  const auto strange = [] { row("report", "is not laid out as this program does it"); };
  try {
    print_report(parse_json(report, "report"), meta.units);
  } catch (const ordered_json::exception&) {
    strange();
  } catch (const FormatError&) {
    strange();
  }
}

void run(const Options& o) {
  const GridReader reader(o.grid);
  if (!o.json) return print(reader);
  std::cout << info_json(reader).dump() << "\n";
}

}  // namespace

Run setup_info(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.add_option("grid", o->grid, "a .tcell file")->required();
  app.add_flag("--json", o->json, "as JSON");
  app.footer("Example:\n  teracell info g.tcell");
  return [o] { run(*o); };
}

}  // namespace teracell
