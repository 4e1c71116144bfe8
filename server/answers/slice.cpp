// A slice as a picture; and one along any plane, as a picture or as sets of labels.
#include "server/answers/answers.hpp"

#include <fmt/format.h>

#include "server/parts/picture_parts.hpp"
#include "server/render/plane.hpp"

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

Response answer_plane(const GridRequest& r) {
  const auto [name, extension] = split_name(r.rest[1]);
  if (name != "plane" || (extension != ".png" && extension != ".bin"))
    throw not_found(fmt::format("expected plane.png or plane.bin, found '{}'", r.rest[1].substr(0, 48)));
  const bool is_picture = extension == ".png";
  std::vector<std::string_view> known = {"v", "window", is_picture ? "materials" : "bodies"};
  for (const RenderOption& option : plane_options()) known.push_back(option.name);
  r.target.allow(known);
  if (!r.target.find("plane")) throw bad_request("plane: expected it, as in plane=1,1,0,25, found none");
  PlaneView view = parse_plane_view([&](std::string_view option) { return r.target.find(option); }, r.meta().grid, "");
  const PixelWindow window = window_of(r.target, view.i1, view.j1);
  if (const uint64_t most = std::min(r.service.options().max_pixels, kMostOutlined); window.height() > most / window.width())
    throw bad_request(
        fmt::format("window: expected at most {} pixels, found {} x {}: ask for the picture part by part", most, window.width(), window.height()));
  const int64_t height = view.j1;
  view.i0 = window.x0, view.i1 = window.x1, view.j0 = height - window.y1, view.j1 = height - window.y0;
  if (is_picture)
    return r.answer({.route = "plane", .content_type = "image/png", .make = [&r, view, style = PictureStyle{.shown = materials_asked_for(r)}] {
                       return picture_png(r.reader(), view, style);
                     }});
  return r.answer(
      {.route = "plane_bin", .content_type = "application/octet-stream", .compress = true, .make = [&r, view, bodies = asks_for_bodies(r)] {
         return bodies ? raw_label_sets(r.reader(), view) : raw_sets(r.reader(), view);
       }});
}

// What is as small as a tile of a slice costs little more than one.
Cost cost_of_plane(const Target& target) { return pixels_asked_for(target) <= kTilePixels * kTilePixels ? Cost::kSeen : Cost::kDear; }

}  // namespace

const Answer kSliceAnswer = {"slice", 3, Cost::kDear, answer_slice};
const Answer kPlaneAnswer = {"slice", 2, Cost::kDear, answer_plane, cost_of_plane};

}  // namespace teracell::server
