// What the pixels of a picture in three dimensions show, as numbers: for a page that colours and moves it by itself.
// The bytes are described in server/SERVING.md, "What is seen, as numbers".
#pragma once
#include <string>

#include "server/render/caster.hpp"

namespace teracell::server {

// Of the pixels of a window. `quick`: with one line of sight for each pixel. A picture's windows, side by side, are the picture.
std::string encode_sights(const Viewed& viewed, const Prepared& prepared, const Aim& aim, const Window& window, bool quick, int threads,
                          const Caster::Progress& progress);

// What is seen at a point of a picture, in pixels from its upper left corner, and the cell that it belongs to.
std::optional<Hit> seen_at(const Viewed& viewed, const Prepared& prepared, const Aim& aim, double x, double y);

}  // namespace teracell::server
