// teracell stats: exact cells, volume and box of every material.
#include <iostream>

#include <fmt/format.h>

#include "store/info.hpp"
#include "store/number_text.hpp"
#include "tools/cli/command.hpp"

namespace teracell {
namespace {

struct StatsArguments {
  GridArgument grid;
  std::optional<std::string> region;
  bool json = false;
};

void run(const StatsArguments& o) {
  const GridReader reader = open_grid(o.grid);
  const Metadata& meta = reader.meta();
  const Box box = !o.region ? meta.grid.box(0) : parse_region(*o.region, meta.grid, 0);
  const auto stats = read_stats(reader, box);
  if (o.json) {
    std::cout << stats_json(meta, box, stats) << "\n";
    return;
  }
  size_t width = 8;
  for (const MaterialInfo& m : meta.materials) width = std::max(width, m.name.size());
  say(fmt::format("{:>3}  {:<{}} {:>20} {:>16}   box of cells", "id", "material", width, "cells", fmt::format("volume {}³", meta.units)));
  for (size_t i = 0; i < stats.size(); ++i) {
    const MaterialStats& s = stats[i];
    const auto& [lo, hi] = s.box;
    const std::string where = s.cells == 0 ? "-" : fmt::format("({}, {}, {}) to ({}, {}, {})", lo[0], lo[1], lo[2], hi[0], hi[1], hi[2]);
    say(fmt::format("{:>3}  {:<{}} {:>20} {:>16}   {}", i, meta.materials[i].name, width, s.cells, number_text(s.volume, 8), where));
  }
}

}  // namespace

Run setup_stats(CLI::App& app) {
  const auto o = std::make_shared<StatsArguments>();
  add_grid(app, o->grid);
  app.add_option("--region", o->region, "X0,Y0,Z0,X1,Y1,Z1: half open, in cells (default: the whole grid)");
  app.add_flag("--json", o->json, "as JSON");
  app.footer("The counts are exact; they come from runs, without expanding a cell. Example:\n  teracell stats g.tcell --region 0,0,0,100,100,100");
  return [o] { run(*o); };
}

}  // namespace teracell
