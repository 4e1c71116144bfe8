// A slice as a picture.
#include "server/api/answers.hpp"

#include <fmt/format.h>

#include "server/parts/picture_parts.hpp"

namespace teracell::server {
namespace {

Response answer_slice(const GridRequest& r) {
  r.target.allow({"v", "level", "region", "materials", "outline", "shares"});
  const int axis = axis_of(r.rest[1]), level = level_of(r.target.find("level"), r.reader());
  const auto [index, extension] = split_name(r.rest[2]);
  if (extension != ".png") throw not_found(fmt::format("slices are .png, found '{}'", extension.substr(0, 48)));
  const Index3 n = r.meta().grid.cells(level);
  SliceView view = whole_slice(r.meta(), axis, integer_in(index, "index", 0, n[axis] - 1), level);
  if (const std::string* region = r.target.find("region")) {
    const auto c = integers(*region, 4, "region");
    view.u0 = c[0], view.v0 = c[1], view.u1 = c[2], view.v1 = c[3];
    check_view(r.meta(), view);
  }
  const auto width = static_cast<uint64_t>(view.u1 - view.u0), height = static_cast<uint64_t>(view.v1 - view.v0);
  if (const uint64_t most = r.service.options().max_pixels; height > most / width)
    throw bad_request(
        fmt::format("region: expected at most {} pixels, found {} x {}: ask for a part with region= or for a coarser level", most, width, height));
  return picture_answer(r, "slice", view);
}

}  // namespace

const Answer kSliceAnswer = {"slice", 3, Cost::kDear, answer_slice};

}  // namespace teracell::server
