// A tile of a slice, as a picture or as labels.
#include "server/api/answers.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/parts/picture_parts.hpp"

namespace teracell::server {
namespace {

Response answer_tile(const GridRequest& r) {
  const int axis = axis_of(r.rest[1]), level = level_of(&r.rest[3], r.reader());
  const Index3 n = r.meta().grid.cells(level);
  SliceView view = whole_slice(r.meta(), axis, integer_in(r.rest[2], "index", 0, n[axis] - 1), level);
  const auto [place, extension] = split_name(r.rest[4]);
  const auto [col, row] = split_pair(place, "tile");
  const int64_t u = integer_in(col, "column", 0, Axis::kMaxCells), v = integer_in(row, "row", 0, Axis::kMaxCells);
  const auto tiles = [](int64_t cells) { return (cells + kTilePixels - 1) / kTilePixels; };
  if (u >= tiles(view.u1) || v >= tiles(view.v1))
    throw not_found(
        fmt::format("there is no tile {}_{}: level {} has columns 0 to {} and rows 0 to {}", u, v, level, tiles(view.u1) - 1, tiles(view.v1) - 1));
  view.u0 = u * kTilePixels, view.v0 = v * kTilePixels;
  view.u1 = std::min(view.u1, view.u0 + kTilePixels), view.v1 = std::min(view.v1, view.v0 + kTilePixels);
  if (extension == ".bin") {
    r.target.allow({"v", "sets", "bodies", "shares"});
    const bool sets = switched_on(r.target, "sets"), bodies = asks_for_bodies(r);
    const FractionReader* const shares = asks_for_shares(r.target, *r.grid);
    if (bodies && !sets) throw bad_request("bodies: expected sets=1 beside it");
    if (shares && !sets) throw bad_request("shares: expected sets=1 beside it");
    return r.answer(
        {.route = "tile_bin", .content_type = "application/octet-stream", .compress = true, .make = [&] {
           return bodies ? raw_label_sets(r.reader(), view, shares) : sets ? raw_sets(r.reader(), view, shares) : raw_labels(r.reader(), view);
         }});
  }
  if (extension != ".png") throw not_found(fmt::format("tiles are .png or .bin, found '{}'", extension.substr(0, 48)));
  r.target.allow({"v", "materials", "outline", "shares"});
  return picture_answer(r, "tile", view);
}

}  // namespace

const Answer kTileAnswer = {"tile", 5, Cost::kCheap, answer_tile};

}  // namespace teracell::server
