#include "server/answers/answer.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include "server/parts/picture_parts.hpp"
#include "store/text/text.hpp"

namespace teracell::server {

int axis_of(const std::string& name) {
  if (const auto axis = axis_named(name)) return *axis;
  throw bad_request(fmt::format("axis: expected x, y or z, found '{}'", name.substr(0, 48)));
}

std::pair<std::string, std::string> split_name(const std::string& name) {
  const size_t dot = std::min(name.find('.'), name.size());
  return {name.substr(0, dot), name.substr(dot)};
}

std::pair<std::string, std::string> split_pair(const std::string& text, const char* what) {
  const size_t sign = text.find('_');
  if (sign == std::string::npos) throw bad_request(fmt::format("{}: expected two whole numbers joined by '_', found '{}'", what, text.substr(0, 48)));
  return {text.substr(0, sign), text.substr(sign + 1)};
}

int level_of(const std::string* text, const GridReader& reader) {
  return text ? static_cast<int>(integer_in(*text, "level", 0, reader.levels() - 1)) : 0;
}

std::pair<SliceView, std::string> tile_of(const GridRequest& r) {
  const int axis = axis_of(r.rest[1]), level = level_of(&r.rest[3], r.reader());
  const Index3 n = r.meta().grid.cells(level);
  SliceView view = whole_slice(r.meta(), axis, integer_in(r.rest[2], "index", 0, n[axis] - 1), level);
  auto [place, extension] = split_name(r.rest[4]);
  const auto [col, row] = split_pair(place, "tile");
  const int64_t u = integer_in(col, "column", 0, Axis::kMaxCells), v = integer_in(row, "row", 0, Axis::kMaxCells);
  const auto tiles = [](int64_t cells) { return (cells + kTilePixels - 1) / kTilePixels; };
  if (u >= tiles(view.u1) || v >= tiles(view.v1))
    throw not_found(
        fmt::format("there is no tile {}_{}: level {} has columns 0 to {} and rows 0 to {}", u, v, level, tiles(view.u1) - 1, tiles(view.v1) - 1));
  view.u0 = u * kTilePixels, view.v0 = v * kTilePixels;
  view.u1 = std::min(view.u1, view.u0 + kTilePixels), view.v1 = std::min(view.v1, view.v0 + kTilePixels);
  return {view, std::move(extension)};
}

bool switched_on(const Target& target, const char* name) {
  const std::string* text = target.find(name);
  return text && integer_in(*text, name, 0, 1) == 1;
}

const FractionReader* asks_for_shares(const Target& target, const ServedGrid& grid) {
  if (!switched_on(target, "shares")) return nullptr;
  if (!grid.fractions) throw UsageError("shares: the grid has none: it was meshed without fractions");
  return grid.fractions.get();
}

PixelWindow window_of(const Target& target, int64_t width, int64_t height) {
  const std::string* const text = target.find("window");
  if (!text) return {0, 0, width, height};
  const auto c = integers(*text, 4, "window");
  if (c[0] < 0 || c[1] < 0 || c[2] > width || c[3] > height || c[0] >= c[2] || c[1] >= c[3])
    throw bad_request(
        fmt::format("window: expected X0,Y0,X1,Y1, a part of 0,0,{},{} (half open, not empty), found '{}'", width, height, text->substr(0, 48)));
  return {c[0], c[1], c[2], c[3]};
}

double pixels_asked_for(const Target& target) {
  const std::string *window = target.find("window"), *size = target.find("size");
  if (window) {
    const auto n = integers(*window, 4, "window");
    // The differences of any whole numbers fit into doubles, not into integers.
    return (static_cast<double>(n[2]) - static_cast<double>(n[0])) * (static_cast<double>(n[3]) - static_cast<double>(n[1]));
  }
  if (!size) return std::numeric_limits<double>::infinity();
  const auto n = integers(*size, 2, "size");
  return static_cast<double>(n[0]) * static_cast<double>(n[1]);
}

Box region_of(const GridRequest& r) {
  Box box = r.meta().grid.box(0);
  if (const std::string* region = r.target.find("region")) {
    const auto c = integers(*region, 6, "region");
    const Index3 n = r.meta().grid.cells();
    for (int d = 0; d < 3; ++d) {
      box.lo[d] = c[d], box.hi[d] = c[d + 3];
      if (box.lo[d] < 0 || box.hi[d] > n[d] || box.lo[d] >= box.hi[d])
        throw bad_request(
            fmt::format("region: expected a part of 0 to {} along {} (half open, not empty), found {} to {}", n[d], axis_name(d), c[d], c[d + 3]));
    }
  }
  return box;
}

bool asks_for_bodies(const GridRequest& r) {
  const bool asks = switched_on(r.target, "bodies");
  if (asks && !keeps_bodies(r.meta())) throw bad_request(fmt::format("bodies: grid '{}' keeps materials, not bodies", r.grid->id));
  return asks;
}

Response json_answer(const GridRequest& r, const char* route, std::function<std::string()> make) {
  return r.answer({.route = route, .content_type = kJsonType, .compress = true, .make = std::move(make)});
}

Index3 cell_asked_for(const GridRequest& r) {
  const std::string* const text = r.target.find("cell");
  if (!text) throw bad_request("missing cell: expected I,J,K, a cell of the grid");
  const auto given = integers(*text, 3, "cell");
  const Index3 cell = {given[0], given[1], given[2]}, n = r.meta().grid.cells();
  for (int d = 0; d < 3; ++d)
    if (cell[d] < 0 || cell[d] >= n[d])
      throw bad_request(fmt::format("cell: expected one of the grid, along {} from 0 to {}, found {}", "xyz"[d], n[d] - 1, cell[d]));
  return cell;
}

std::vector<bool> materials_asked_for(const GridRequest& r) {
  const std::string* const list = r.target.find("materials");
  if (!list) return {};
  const size_t n = r.meta().materials.size();
  std::vector<bool> out(n);
  if (!list->empty())
    for (const std::string_view text : split(*list, ',')) {
      const auto id = plain_integer(text);
      if (!id || static_cast<size_t>(*id) >= n)
        throw bad_request(fmt::format("materials: expected ids from 0 to {} separated by commas, as the grid's description lists them, found '{}'",
                                      n - 1, text.substr(0, 48)));
      out[static_cast<size_t>(*id)] = true;
    }
  return out;
}

Response picture_answer(const GridRequest& r, const char* route, const SliceView& view) {
  const PictureStyle style = {
      .shown = materials_asked_for(r), .outline = switched_on(r.target, "outline"), .shares = asks_for_shares(r.target, *r.grid)};
  Service::Recipe recipe = picture_recipe(r.reader(), view, style);
  recipe.route = route;
  return r.answer(recipe);
}

}  // namespace teracell::server
