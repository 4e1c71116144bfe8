// The box of some labels, and a cell near a place, or near its middle, that has one of them.
#include "server/answers/answers.hpp"

#include <fmt/format.h>

#include "store/read/nearest.hpp"
#include "store/text/json_writer.hpp"
#include "store/text/text.hpp"
#include "store/text/words.hpp"

namespace teracell::server {
namespace {

Response answer_nearest(const GridRequest& r) {
  r.target.allow({"v", "labels", "cell"});
  const std::string* const list = r.target.find("labels");
  if (!list) throw bad_request("missing labels: expected numbers of labels and ranges of them, as in 1-4,7");
  const size_t n = r.meta().labels.size();
  const auto labels = ranges_in(*list, n);
  if (!labels)
    throw bad_request(fmt::format("labels: expected numbers from 0 to {} and ranges of them, as in 1-4,7, found '{}'", n - 1, shortened(*list)));
  const auto to = r.target.find("cell") ? std::optional(cell_asked_for(r)) : std::nullopt;
  return json_answer(r, "nearest", [&r, labels = *labels, to] {
    std::string text;
    const auto [box, cell] = read_nearest(r.reader(), labels, to);
    JsonWriter out(text);
    out.begin_object().field("schema", 1).field("cell", cell).field("box", box.empty() ? std::nullopt : std::optional(box.corners())).end_object();
    return text;
  });
}

}  // namespace

const Answer kNearestAnswer = {"nearest", 1, Cost::kSeen, answer_nearest};

}  // namespace teracell::server
