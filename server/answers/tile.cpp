// A tile of a slice, as a picture or as labels.
#include "server/answers/answers.hpp"

#include <fmt/format.h>

#include "server/parts/picture_parts.hpp"

namespace teracell::server {
namespace {

Response answer_tile(const GridRequest& r) {
  const auto [view, extension] = tile_of(r);
  if (extension == ".bin") {
    r.target.allow({"v", "sets", "bodies", "shares", "damage"});
    const bool sets = switched_on(r.target, "sets"), bodies = asks_for_bodies(r), damage = switched_on(r.target, "damage");
    const FractionReader* const shares = asks_for_shares(r.target, *r.grid);
    if (bodies && !sets) throw bad_request("bodies: expected sets=1 beside it");
    if (shares && !sets) throw bad_request("shares: expected sets=1 beside it");
    if (damage && (!sets || shares)) throw bad_request(fmt::format("damage: expected sets=1 beside it{}", shares ? ", and no shares" : ""));
    return r.answer(
        {.route = "tile_bin", .content_type = "application/octet-stream", .compress = true, .make = [&r, tile = view, sets, bodies, shares, damage] {
           return bodies ? raw_label_sets(r.reader(), tile, shares, damage)
                  : sets ? raw_sets(r.reader(), tile, shares, damage)
                         : raw_labels(r.reader(), tile);
         }});
  }
  if (extension != ".png") throw not_found(fmt::format("tiles are .png or .bin, found '{}'", extension.substr(0, 48)));
  r.target.allow({"v", "materials", "outline", "shares"});
  return picture_answer(r, "tile", view);
}

}  // namespace

const Answer kTileAnswer = {"tile", 5, Cost::kCheap, answer_tile};

}  // namespace teracell::server
