// The runs of a column of cells.
#include "server/answers/answers.hpp"

#include "server/parts/column_parts.hpp"

namespace teracell::server {
namespace {

Response answer_column(const GridRequest& r) {
  r.target.allow({"v", "from", "to"});
  const int axis = axis_of(r.rest[1]);
  const RayFrame f = RayFrame::along(axis);
  const Index3 n = r.meta().grid.cells();
  const auto [a_text, b_text] = split_pair(r.rest[2], "column");
  const int64_t a = integer_in(a_text, axis_name(f.u), 0, n[f.u] - 1), b = integer_in(b_text, axis_name(f.v), 0, n[f.v] - 1);
  int64_t from = 0, to = n[axis];
  if (const std::string* text = r.target.find("from")) from = integer_in(*text, "from", 0, n[axis] - 1);
  if (const std::string* text = r.target.find("to")) to = integer_in(*text, "to", from + 1, n[axis]);
  return r.answer(
      {.route = "column", .content_type = kJsonType, .compress = true, .parts = [&] { return column_parts(r.reader(), axis, a, b, from, to); }});
}

}  // namespace

const Answer kColumnAnswer = {"column", 3, Cost::kSeen, answer_column};

}  // namespace teracell::server
