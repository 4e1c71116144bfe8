// teracell stats: exact cells, volume and box of every material, or of every body.
#include <iostream>

#include <fmt/format.h>

#include "store/grid/number_text.hpp"
#include "store/whole/info.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {
namespace {

struct StatsArguments {
  GridArgument grid;
  std::optional<std::string> region;
  bool bodies = false, json = false;
};

// What the rows are of, and the texts of the rows in front of their counts.
struct Rows {
  std::string head;
  std::vector<std::string> names;
};

Rows materials_of(const Metadata& meta) {
  Rows rows{"material", {}};
  for (const MaterialInfo& m : meta.materials) rows.names.push_back(m.name);
  return rows;
}

Rows bodies_of(const Metadata& meta) {
  Rows rows{"body: material", {}};
  for (const LabelInfo& l : meta.labels) {
    const std::string& material = meta.materials[l.material].name;
    rows.names.push_back(l.body.empty() ? material : fmt::format("{}{}: {}", l.body, l.overlap ? ", in others too" : "", material));
  }
  return rows;
}

void print(const Metadata& meta, const Rows& rows, const std::vector<CellStats>& stats) {
  size_t width = rows.head.size();
  for (const std::string& name : rows.names) width = std::max(width, name.size());
  say(fmt::format("{:>3}  {:<{}} {:>20} {:>16}   box of cells", "id", rows.head, width, "cells", fmt::format("volume, {}³", meta.units)));
  for (size_t i = 0; i < stats.size(); ++i) {
    const CellStats& s = stats[i];
    const auto& [lo, hi] = s.box;
    const std::string where = s.cells == 0 ? "-" : fmt::format("({}, {}, {}) to ({}, {}, {})", lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]);
    say(fmt::format("{:>3}  {:<{}} {:>20} {:>16}   {}", i, rows.names[i], width, fmt::group_digits(s.cells), number_text(s.volume, 8), where));
  }
}

void run(const StatsArguments& o) {
  const GridReader reader = open_grid(o.grid);
  const Metadata& meta = reader.meta();
  const Box box = !o.region ? meta.grid.box(0) : parse_region(*o.region, meta.grid, 0);
  if (o.bodies && !keeps_bodies(meta))
    throw UsageError(fmt::format("{}: it keeps materials, not bodies: mesh the scene with \"label_by\": \"body\"", reader.name()));
  const auto stats = read_label_stats(reader, box);
  if (o.json) std::cout << (o.bodies ? body_stats_json(meta, box, stats) : stats_json(meta, box, stats_by_material(meta, stats))) << "\n";
  else if (o.bodies) print(meta, bodies_of(meta), stats);
  else print(meta, materials_of(meta), stats_by_material(meta, stats));
}

}  // namespace

Run setup_stats(CLI::App& app) {
  const auto o = std::make_shared<StatsArguments>();
  add_grid(app, o->grid);
  app.add_option("--region", o->region, "X0,Y0,Z0,X1,Y1,Z1: half open, in cells (default: the whole grid)");
  app.add_flag("--bodies", o->bodies, "of every body, where the grid keeps bodies apart");
  app.add_flag("--json", o->json, "as JSON");
  app.footer("The counts are exact; they come from runs, without expanding a cell. Example:\n  teracell stats g.tcell --region 0,0,0,100,100,100");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
