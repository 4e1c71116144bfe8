// teracell column: the runs of one column of cells.
#include <iostream>

#include <fmt/format.h>

#include "store/whole/info.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {
namespace {

struct ColumnArguments {
  GridArgument grid;
  std::string axis, at;
  bool json = false;
};

void run(const ColumnArguments& o) {
  const GridReader reader = open_grid(o.grid);
  const Metadata& meta = reader.meta();
  const int axis = parse_axis(o.axis);
  const auto at = parse_integers(o.at, 2, "--at");
  const auto runs = read_column(reader, axis, at[0], at[1]);
  if (o.json) {
    std::cout << column_json(meta, axis, at[0], at[1], runs) << "\n";
    return;
  }
  const RayFrame f = RayFrame::along(axis);
  say(fmt::format("column along {} at {} = {}, {} = {}", o.axis, axis_name(f.u), at[0], axis_name(f.v), at[1]));
  say("");
  say(fmt::format("{:>12} {:>12} {:>14} {:>14}  material", "from cell", "to cell", "from " + meta.units, "to " + meta.units));
  for (const ColumnRun& r : runs)
    say(fmt::format("{:>12} {:>12} {:>14.8g} {:>14.8g}  {}", r.from, r.to, meta.grid.axis[axis].plane(r.from), meta.grid.axis[axis].plane(r.to),
                    meta.materials[r.material].name));
}

}  // namespace

Run setup_column(CLI::App& app) {
  const auto o = std::make_shared<ColumnArguments>();
  add_grid(app, o->grid);
  app.add_option("--axis", o->axis, "the axis that the column is along: x, y or z")->required();
  app.add_option("--at", o->at, "I,J: the cells on the other two axes: x,y for a column along z, x,z along y, y,z along x")->required();
  app.add_flag("--json", o->json, "as JSON");
  app.footer("Runs are half open: [from, to). Example:\n  teracell column g.tcell --axis z --at 100,200");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
