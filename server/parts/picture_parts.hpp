// Pictures of any size, made as they are taken: no more of a large one than a part and a row is ever in memory.
#pragma once
#include <memory>

#include "server/parts/slice_picture.hpp"
#include "server/service/service.hpp"

namespace teracell::server {

// The view as PNG in parts, the row with the highest v on top. REQUIRES: `reader` outlives it. Throws UsageError for outlines and shares.
std::unique_ptr<Parts> picture_parts(const GridReader& reader, const SliceView& view, const PictureStyle& style = {});

// How to answer with a picture: whole, or in parts when it has more than kMostOutlined pixels. REQUIRES: `reader` outlives it.
Service::Recipe picture_recipe(const GridReader& reader, const SliceView& view, const PictureStyle& style = {});

}  // namespace teracell::server
