// The cell near a place that has one of some labels.
#include "server/answers/answers.hpp"

#include <fmt/format.h>

#include "store/read/nearest.hpp"
#include "store/text/json_writer.hpp"
#include "store/text/text.hpp"

namespace teracell::server {
namespace {

Response answer_nearest(const GridRequest& r) {
  r.target.allow({"v", "labels", "cell"});
  const std::string* const list = r.target.find("labels");
  if (!list) throw bad_request("missing labels: expected numbers separated by commas");
  const size_t n = r.meta().labels.size();
  const Index3 to = cell_asked_for(r);
  std::vector<bool> labels(n);
  for (const std::string_view text : split(*list, ',')) {
    const auto label = plain_integer(text);
    if (!label || static_cast<size_t>(*label) >= n)
      throw bad_request(fmt::format("labels: expected numbers from 0 to {} separated by commas, found '{}'", n - 1, text.substr(0, 48)));
    labels[static_cast<size_t>(*label)] = true;
  }
  return json_answer(r, "nearest", [&r, labels, to] {
    std::string text;
    JsonWriter out(text);
    out.begin_object().field("schema", 1).key("cell");
    if (const auto cell = read_nearest(r.reader(), labels, to)) out.value(*cell);
    else out.value(nullptr);
    out.end_object();
    return text;
  });
}

}  // namespace

const Answer kNearestAnswer = {"nearest", 1, Cost::kSeen, answer_nearest};

}  // namespace teracell::server
