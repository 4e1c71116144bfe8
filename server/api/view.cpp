#include "server/api/view.hpp"

#include <charconv>

#include <fmt/format.h>

#include "server/render/encode.hpp"
#include "server/render/options.hpp"
#include "server/render/sights.hpp"
#include "store/text/json_writer.hpp"

namespace teracell::server {
namespace {

constexpr uint64_t kMostPixels = uint64_t{1} << 23;  // others wait meanwhile, so there are fewer than in a slice
const auto kQuietly = [](double) {};

RenderOptions options_of(const ServedGrid& grid, const Target& target, std::initializer_list<std::string_view> more) {
  std::vector<std::string_view> known = {"v"};
  for (const RenderOption& option : render_options()) known.push_back(option.name);
  known.insert(known.end(), more);
  target.allow(known);
  return parse_render_options([&](std::string_view name) { return target.find(name); }, grid.meta(), "");
}

std::shared_ptr<const Prepared> prepared_for(Service& service, const ServedGrid& grid, const RenderOptions& options) {
  const std::vector<bool> shown = shown_labels(grid.meta(), options);
  const int level = options.aim.level.value_or(0);
  std::string key = fmt::format("{} {} ", grid.number, level);
  for (const bool one : shown) key += one ? '1' : '0';
  return service.prepared().get(key, [&] {
    auto prepared = std::make_shared<const Prepared>(grid.reader(), shown, level, 1);
    const size_t bytes = prepared->memory();
    return std::pair(std::move(prepared), bytes);
  });
}

void check_size(const Service& service, const char* what, uint64_t width, uint64_t height) {
  if (const uint64_t most = std::min(service.options().max_pixels, kMostPixels); width * height > most)
    throw bad_request(fmt::format("{}: expected at most {} pixels, found {} x {}", what, most, width, height));
}

Service::Recipe picture(Service& service, const ServedGrid& grid, const Target& target) {
  const RenderOptions options = options_of(grid, target, {});
  check_size(service, "size", options.aim.camera.size.width, options.aim.camera.size.height);
  return {.route = "view", .content_type = "image/png", .make = [&service, &grid, options] {
            return encode_picture(render(grid.reader(), *prepared_for(service, grid, options), options, 1, kQuietly), "png");
          }};
}

Service::Recipe numbers(Service& service, const ServedGrid& grid, const Target& target) {
  const RenderOptions options = options_of(grid, target, {"window", "quick"});
  const PictureSize size = options.aim.camera.size;
  Window window{0, 0, size.width, size.height};
  if (const std::string* text = target.find("window")) {
    const auto c = integers(*text, 4, "window");
    window = {c[0], c[1], c[2], c[3]};
    if (window.x0 < 0 || window.y0 < 0 || window.x1 > size.width || window.y1 > size.height || window.x0 >= window.x1 || window.y0 >= window.y1)
      throw bad_request(fmt::format("window: expected X0,Y0,X1,Y1, a part of 0,0,{},{} (half open, not empty), found '{}'", size.width, size.height,
                                    text->substr(0, 48)));
  }
  check_size(service, "window", static_cast<uint64_t>(window.width()), static_cast<uint64_t>(window.height()));
  const std::string* quick = target.find("quick");
  const bool is_quick = quick && integer_in(*quick, "quick", 0, 1) == 1;
  return {.route = "view_bin", .content_type = "application/octet-stream", .compress = true, .make = [&service, &grid, options, window, is_quick] {
            return encode_sights(grid.reader(), *prepared_for(service, grid, options), options.aim, window, is_quick, 1, kQuietly);
          }};
}

// {"x,y"} in pixels.
std::pair<double, double> pixel_of(const Target& target) {
  const auto refuse = [](std::string_view found) -> HttpError {
    return bad_request(fmt::format("pixel: expected two numbers, as in 320.5,240.5, found '{}'", found.substr(0, 48)));
  };
  const std::string* text = target.find("pixel");
  if (!text) throw refuse("");
  double out[2];
  const char *at = text->data(), *const end = at + text->size();
  for (int i = 0; i < 2; ++i) {
    const auto [next, error] = std::from_chars(at, end, out[i]);
    if (error != std::errc{} || !(std::abs(out[i]) < 1e9) || (i == 0 ? next == end || *next != ',' : next != end)) throw refuse(*text);
    at = next + 1;
  }
  return {out[0], out[1]};
}

std::string point_json(const ServedGrid& grid, const Prepared& prepared, const RenderOptions& options, double x, double y) {
  const Metadata& meta = grid.meta();
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).key("seen");
  if (const auto hit = seen_at(grid.reader(), prepared, options.aim, x, y)) {
    const Sight sight = options.aim.camera.sight(x, y);
    const LabelInfo& label = meta.labels[hit->label];
    out.begin_object().field("at", sight.from + sight.along * hit->t).field("cell", hit->cell).field("level", hit->level);
    out.field("distance", hit->t).field("label", hit->label).field("material", label.material).key("body");
    if (label.body.empty()) out.value(nullptr);
    else out.value(label.body);
    out.end_object();
  } else {
    out.value(nullptr);
  }
  out.end_object();
  return text;
}

Service::Recipe point(Service& service, const ServedGrid& grid, const Target& target) {
  const RenderOptions options = options_of(grid, target, {"pixel"});
  const auto [x, y] = pixel_of(target);
  return {.route = "view_json", .content_type = "application/json", .make = [&service, &grid, options, x = x, y = y] {
            return point_json(grid, *prepared_for(service, grid, options), options, x, y);
          }};
}

}  // namespace

std::optional<Service::Recipe> view_recipe(Service& service, const ServedGrid& grid, const Target& target, std::string_view ending) {
  if (ending == ".png") return picture(service, grid, target);
  if (ending == ".bin") return numbers(service, grid, target);
  if (ending == ".json") return point(service, grid, target);
  return std::nullopt;
}

}  // namespace teracell::server
