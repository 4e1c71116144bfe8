// teracell column: the runs of one column of cells.
#include <iostream>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/words.hpp"
#include "store/whole/info.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {
namespace {

struct ColumnArguments {
  GridArgument grid;
  std::string axis, at, place;
  bool json = false;
};

// The cells on the other two axes.
std::vector<int64_t> cells_of(const ColumnArguments& o, const Metadata& meta, int axis) {
  if (o.at.empty() == o.place.empty())
    throw UsageError(fmt::format("--at, --place: expected one of them, found {}", o.at.empty() ? "neither" : "both"));
  if (o.place.empty()) return parse_integers(o.at, 2, "--at");
  const auto place = numbers_in<double>(o.place, 2);
  if (!place) throw UsageError(fmt::format("--place: expected 2 coordinates separated by a comma, as in 1.5,20, found '{}'", o.place));
  const RayFrame frame = RayFrame::along(axis);
  std::vector<int64_t> out;
  for (const int d : {frame.u, frame.v}) out.push_back(cell_of((*place)[out.size()], meta, d, "--place"));
  return out;
}

void run(const ColumnArguments& o) {
  const GridReader reader = open_grid(o.grid);
  const Metadata& meta = reader.meta();
  const int axis = parse_axis(o.axis);
  const std::vector<int64_t> at = cells_of(o, meta, axis);
  const auto runs = read_column(reader, axis, at[0], at[1]);
  if (o.json) {
    std::cout << column_json(meta, axis, at[0], at[1], runs) << "\n";
    return;
  }
  const RayFrame f = RayFrame::along(axis);
  const auto cell = [&](int d, int64_t i) {
    const Axis& a = meta.grid.axis[d];
    return fmt::format("{} = {:.8g} to {:.8g} {} (cell {})", axis_name(d), a.plane(i), a.plane(i + 1), meta.units, i);
  };
  say(fmt::format("column along {} at {}, {}", o.axis, cell(f.u, at[0]), cell(f.v, at[1])));
  say("");
  say(fmt::format("{:>12} {:>12} {:>14} {:>14}  material", "from cell", "to cell", "from, " + meta.units, "to, " + meta.units));
  for (const ColumnRun& r : runs)
    say(fmt::format("{:>12} {:>12} {:>14.8g} {:>14.8g}  {}", r.from, r.to, meta.grid.axis[axis].plane(r.from), meta.grid.axis[axis].plane(r.to),
                    meta.materials[r.material].name));
}

}  // namespace

Run setup_column(CLI::App& app) {
  const auto o = std::make_shared<ColumnArguments>();
  add_grid(app, o->grid);
  app.add_option("--axis", o->axis, "the axis that the column is along: x, y or z")->required();
  app.add_option("--at", o->at, "I,J: the cells on the other two axes: x,y for a column along z, x,z along y, y,z along x");
  app.add_option("--place", o->place, "X,Y: coordinates on these two axes instead");
  app.add_flag("--json", o->json, "as JSON");
  app.footer(
      "Runs are half open: [from, to). Example:\n  teracell column g.tcell --axis z --at 100,200\n  teracell column g.tcell --axis z --place 12.5,-3");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
