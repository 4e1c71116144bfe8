// IIIF Image API 3.0, level 0: the tiles that info.json lists, the whole picture at the scales of the tiles, and nothing else.
#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/protocols/protocols.hpp"
#include "server/protocols/scaled_slice.hpp"

namespace teracell::server {
namespace {

using nlohmann::ordered_json;

constexpr const char* kPrefix = "iiif";

// "{id}-{axis}-{index}"; an id may hold '-' itself.
struct Name {
  std::string id, axis, index;
};
std::optional<Name> parse_name(const std::string& text) {
  const size_t second = text.rfind('-');
  if (second == std::string::npos || second == 0) return std::nullopt;
  const size_t first = text.rfind('-', second - 1);
  if (first == std::string::npos) return std::nullopt;
  return Name{text.substr(0, first), text.substr(first + 1, second - first - 1), text.substr(second + 1)};
}

// The scale at which the whole picture is one tile.
int last_scale(const ScaledSlice& slice) { return slice.scale_within(kTilePixels); }

// At least one tile, whatever the limit for pictures is.
int64_t most_pixels(const Service& service) {
  return static_cast<int64_t>(std::max<uint64_t>(service.options().max_pixels, kTilePixels * kTilePixels));
}

ordered_json info(const ScaledSlice& slice, const std::string& address, int64_t most) {
  ordered_json sizes = ordered_json::array(), factors = ordered_json::array();
  for (int scale = last_scale(slice); scale >= 0; --scale)
    if (slice.width(scale) * slice.height(scale) <= most) sizes.push_back({{"width", slice.width(scale)}, {"height", slice.height(scale)}});
  for (int scale = 0; scale <= last_scale(slice); ++scale) factors.push_back(int64_t{1} << scale);
  return {{"@context", "http://iiif.io/api/image/3/context.json"},
          {"id", address},
          {"type", "ImageService3"},
          {"protocol", "http://iiif.io/api/image"},
          {"profile", "level0"},
          {"width", slice.width()},
          {"height", slice.height()},
          {"maxArea", most},
          {"sizes", sizes},
          {"tiles", ordered_json::array({{{"width", kTilePixels}, {"height", kTilePixels}, {"scaleFactors", factors}}})},
          {"preferredFormats", ordered_json::array({"png"})}};
}

// A part of the picture, in pixels of scale 0.
struct Region {
  int64_t x, y, w, h;
};
std::optional<Region> parse_region(std::string_view text, const ScaledSlice& slice) {
  if (text == "full") return Region{0, 0, slice.width(), slice.height()};
  const auto parts = split(text, ',');
  if (parts.size() != 4) return std::nullopt;
  std::array<int64_t, 4> n;
  for (size_t i = 0; i < 4; ++i) {
    const auto value = plain_integer(parts[i]);
    if (!value) return std::nullopt;
    n[i] = *value;
  }
  if (n[0] >= slice.width() || n[1] >= slice.height() || n[2] < 1 || n[3] < 1) return std::nullopt;
  return Region{n[0], n[1], n[2], n[3]};
}

// Whether the region is a tile of that scale, or the whole picture.
bool is_offered(const Region& r, int scale, const ScaledSlice& slice) {
  if (r.x == 0 && r.y == 0 && r.w == slice.width() && r.h == slice.height()) return true;
  const int64_t size = kTilePixels << scale;
  return r.x % size == 0 && r.y % size == 0 && r.w == std::min(size, slice.width() - r.x) && r.h == std::min(size, slice.height() - r.y);
}

// Whether `text` asks for w x h pixels: "w,h", "w,", ",h"; or "max" when the region is not scaled.
bool is_size(std::string_view text, int64_t w, int64_t h, int scale) {
  if (text == "max") return scale == 0;
  return text == fmt::format("{},{}", w, h) || text == fmt::format("{},", w) || text == fmt::format(",{}", h);
}

// {region}/{size}/0/default.png
std::optional<Service::Recipe> find_picture(const ScaledSlice& slice, std::span<const std::string> path, int64_t most) {
  if (path.size() != 4 || path[2] != "0" || path[3] != "default.png") return std::nullopt;
  const auto region = parse_region(path[0], slice);
  if (!region) return std::nullopt;
  for (int scale = 0; scale <= last_scale(slice); ++scale) {
    const int64_t w = ceil_shift(region->w, scale), h = ceil_shift(region->h, scale), x = region->x >> scale, y = region->y >> scale;
    if (!is_offered(*region, scale, slice) || !is_size(path[1], w, h, scale)) continue;
    if (w * h > most) throw bad_request(fmt::format("size: expected at most {} pixels, found {} x {}; info.json lists the sizes", most, w, h));
    return slice.picture(scale, x, y, x + w, y + h);
  }
  return std::nullopt;
}

Response serve(const ProtocolRequest& r) {
  const auto name = r.target.path.size() < 2 ? std::nullopt : parse_name(r.target.path[1]);
  if (!name) return missing(r.route);
  const std::string address = r.request.origin + r.request.prefix + "/" + kPrefix + "/" + percent_encoded(r.target.path[1]);
  if (r.target.path.size() == 2) {
    return or_missing(r.route, [&] {
      if (!slice_at(r.service.grids().find(name->id)->reader(), name->axis, name->index)) return missing(r.route);
      Response there;
      there.status = 303;
      there.body = body_of("");
      there.cache_control = "no-cache";
      there.location = address + "/info.json";
      there.route = r.route;
      return there;
    });
  }
  return serve_found(r, name->id, [&](const ServedGrid& grid, std::span<const std::string> path) -> std::optional<Service::Recipe> {
    const auto slice = slice_at(grid.reader(), name->axis, name->index);
    if (!slice) return std::nullopt;
    const int64_t most = most_pixels(r.service);
    if (joined(path) != "info.json") return find_picture(*slice, path, most);
    auto recipe = json_recipe([slice = *slice, address, most] { return info(slice, address, most); });
    recipe.content_type = R"(application/ld+json;profile="http://iiif.io/api/image/3/context.json")";
    recipe.cacheable = false;
    recipe.address = fmt::format("{} {}", address, most);
    return recipe;
  });
}

}  // namespace

Protocol iiif() {
  return {.prefix = kPrefix,
          .route = "iiif",
          .title = "IIIF",
          .address = [](const ServedGrid& g) { return fmt::format("/{}-z-{}/info.json", percent_encoded(g.id), g.meta().grid.cells()[2] / 2); },
          .serve = serve,
          .dear = true};
}

}  // namespace teracell::server
