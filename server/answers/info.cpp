// A grid: its axes, materials and levels, and the report of the mesher.
#include "server/answers/answers.hpp"

#include "store/whole/info.hpp"

namespace teracell::server {
namespace {

Response answer_info(const GridRequest& r) {
  r.target.allow({"v"});
  return json_answer(r, "info", [&] { return info_json(r.reader(), r.grid->id); });
}

}  // namespace

const Answer kInfoAnswer = {"", 0, Cost::kCheap, answer_info};

}  // namespace teracell::server
