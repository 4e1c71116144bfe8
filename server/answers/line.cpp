// The materials along a straight line.
#include "server/answers/answers.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "store/read/line.hpp"
#include "store/whole/info.hpp"

namespace teracell::server {
namespace {

constexpr double kMostLineCells = 1048576;      // 2^20, which take about a second
constexpr double kFarthestEnd = 1e6;            // of a line, as a multiple of the grid's largest coordinate

Response answer_line(const GridRequest& r) {
  r.target.allow({"v", "from", "to"});
  std::array<Vec3, 2> ends;
  // Where along a line it passes from cell to cell is computed in doubles: its ends may not be so far away that these lose the cells.
  double reach = 0;
  for (const Axis& axis : r.meta().grid.axis) reach = std::max({reach, kFarthestEnd * std::abs(axis.min()), kFarthestEnd * std::abs(axis.max())});
  for (const int i : {0, 1}) {
    const char* name = i == 0 ? "from" : "to";
    const std::string* text = r.target.find(name);
    if (!text) throw bad_request(fmt::format("missing {}: expected X,Y,Z, coordinates in {}", name, r.meta().units));
    const auto c = reals(*text, 3, name);
    if (std::ranges::any_of(c, [&](double x) { return !(std::abs(x) <= reach); }))
      throw bad_request(fmt::format("{}: expected three numbers up to {:.6g}, found '{}'", name, reach, *text));
    ends[static_cast<size_t>(i)] = {c[0], c[1], c[2]};
  }
  if (ends[0] == ends[1]) throw bad_request("to: expected another point than from");
  double cells = 1;
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = r.meta().grid.axis[d];
    const auto cell = [&](double x) { return static_cast<double>(axis.cell_at(std::clamp(x, axis.min(), axis.max()))); };
    cells += std::abs(cell(ends[1][static_cast<size_t>(d)]) - cell(ends[0][static_cast<size_t>(d)]));
  }
  if (cells > kMostLineCells) throw bad_request(fmt::format("to: expected a line through at most {:.0f} cells, found {:.0f}", kMostLineCells, cells));
  return json_answer(r, "line", [&, ends] { return line_json(r.meta(), ends[0], ends[1], read_line(r.reader(), ends[0], ends[1])); });
}

}  // namespace

const Answer kLineAnswer = {"line", 1, Cost::kSeen, answer_line};

}  // namespace teracell::server
