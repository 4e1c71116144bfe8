// What `teracell check` has found. It is kept beside the file, and may come or change while the grid stays the same.
#include "server/answers/answers.hpp"

#include <fmt/format.h>

#include "store/check/kept.hpp"

namespace teracell::server {
namespace {

Response answer_check(const GridRequest& r) {
  r.target.allow({});
  std::string text = r.grid->path.empty() ? "" : read_kept_findings(r.grid->path, r.grid->reader());
  if (text.empty()) throw not_found(fmt::format("nobody has looked through the cells of grid '{}' yet: `teracell check` does", r.grid->id));
  Service::Recipe recipe{.route = "check", .content_type = kJsonType, .cacheable = false, .compress = true, .make = [&text] { return text; }};
  recipe.address = text;
  return r.answer(recipe);
}

}  // namespace

const Answer kCheckAnswer = {"check", 1, Cost::kCheap, answer_check};

}  // namespace teracell::server
