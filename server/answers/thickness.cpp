// How thick a material is along the normal of its surface.
#include "server/answers/answers.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "store/grid/vec3.hpp"
#include "store/read/surface.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::server {
namespace {

std::string thickness_json(const GridReader& reader, const Index3& cell, const Vec3& at) {
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).key("thickness");
  if (const auto thick = thickness_at(reader, cell, at)) {
    out.begin_object().field("material", thick->material).field("name", reader.meta().materials[thick->material].name);
    out.field("length", length(thick->to - thick->from)).field("cells", thick->cells).field("normal", thick->normal);
    out.field("from", thick->from).field("to", thick->to).end_object();
  } else {
    out.value(nullptr);
  }
  out.end_object();
  return text;
}

Response answer_thickness(const GridRequest& r) {
  r.target.allow({"v", "cell", "at"});
  const Grid& grid = r.meta().grid;
  const auto numbers = [&](const char* name) {
    const std::string* text = r.target.find(name);
    if (!text) throw bad_request(fmt::format("missing {}: expected three numbers", name));
    return reals(*text, 3, name);
  };
  const std::vector<double> index = numbers("cell"), point = numbers("at");
  Index3 cell;
  Vec3 at;
  for (int d = 0; d < 3; ++d) {
    const auto i = static_cast<size_t>(d);
    const Axis& axis = grid.axis[d];
    if (!(index[i] >= 0 && index[i] < static_cast<double>(axis.cells())) || index[i] != std::floor(index[i]))
      throw bad_request(fmt::format("cell: expected whole numbers, along {} from 0 to {}, found {}", "xyz"[d], axis.cells() - 1, index[i]));
    cell[d] = static_cast<int64_t>(index[i]);
    // Clients may have rounded the point.
    const double low = axis.plane(cell[d]), high = axis.plane(cell[d] + 1), slack = 0.01 * (high - low);
    if (!(point[i] >= low - slack && point[i] <= high + slack))
      throw bad_request(fmt::format("at: expected a point of the cell, along {} from {:.9g} to {:.9g}, found {:.9g}", "xyz"[d], low, high, point[i]));
    at[d] = std::clamp(point[i], low, high);
  }
  return json_answer(r, "thickness", [&r, cell, at] { return thickness_json(r.reader(), cell, at); });
}

}  // namespace

const Answer kThicknessAnswer = {"thickness", 1, Cost::kSeen, answer_thickness};

}  // namespace teracell::server
