// Deep Zoom: a slice as tiles without overlap. Level 0 is a single pixel, the last level is the slice itself.
#include <algorithm>

#include <fmt/format.h>

#include "server/protocols/protocols.hpp"
#include "server/protocols/scaled_slice.hpp"

namespace teracell::server {
namespace {

constexpr std::string_view kDocument = ".dzi", kFolder = "_files", kTile = ".png";

std::optional<std::string_view> without(std::string_view text, std::string_view end) {
  return text.ends_with(end) ? std::optional(text.substr(0, text.size() - end.size())) : std::nullopt;
}

std::string description(const ScaledSlice& slice) {
  return fmt::format(R"(<?xml version="1.0" encoding="UTF-8"?>
<Image xmlns="http://schemas.microsoft.com/deepzoom/2008" Format="png" Overlap="0" TileSize="{}"><Size Width="{}" Height="{}"/></Image>
)",
                     kTilePixels, slice.width(), slice.height());
}

// "{column}_{row}.png" of a scale.
std::optional<Service::Recipe> find_tile(const ScaledSlice& slice, int scale, std::string_view name) {
  const auto numbers = without(name, kTile);
  const auto parts = split(numbers.value_or(""), '_');
  if (parts.size() != 2) return std::nullopt;
  const auto column = plain_integer(parts[0]), row = plain_integer(parts[1]);
  const int64_t width = slice.width(scale), height = slice.height(scale);
  if (!column || !row || *column > (width - 1) / kTilePixels || *row > (height - 1) / kTilePixels) return std::nullopt;
  const int64_t x = *column * kTilePixels, y = *row * kTilePixels;
  return slice.picture(scale, x, y, std::min(x + kTilePixels, width), std::min(y + kTilePixels, height));
}

// {axis}/{index}.dzi and {axis}/{index}_files/{level}/{column}_{row}.png
std::optional<Service::Recipe> find_in_deep_zoom(const ServedGrid& grid, std::span<const std::string> path) {
  if (path.size() != 2 && path.size() != 4) return std::nullopt;
  const bool tile = path.size() == 4;
  const auto index = without(path[1], tile ? kFolder : kDocument);
  const auto slice = index ? slice_at(grid.reader(), path[0], *index) : std::nullopt;
  if (!slice) return std::nullopt;
  if (!tile) return Service::Recipe{.content_type = "application/xml", .make = [s = *slice] { return description(s); }};
  const int last = slice->scale_within(1);
  const auto level = plain_integer(path[2]);
  return level && *level <= last ? find_tile(*slice, last - static_cast<int>(*level), path[3]) : std::nullopt;
}

}  // namespace

Protocol deep_zoom() {
  return {.prefix = "dzi",
          .route = "deep_zoom",
          .title = "Deep Zoom",
          .address = [](const ServedGrid& g) { return fmt::format("/{}/z/{}.dzi", percent_encoded(g.id), g.meta().grid.cells()[2] / 2); },
          .serve = serve_by_id(find_in_deep_zoom),
          .dear = true};
}

}  // namespace teracell::server
