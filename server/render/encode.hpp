// Pictures as files.
#pragma once
#include <string>
#include <string_view>

#include "server/render/render.hpp"

namespace teracell::server {

// What a name ends in, "png" or "jpg"; empty for anything else. Also ".jpeg".
std::string_view picture_format(std::string_view name);
// JPEG has no alpha: what is transparent becomes white.
std::string encode_picture(const Picture3D& picture, std::string_view format);

}  // namespace teracell::server
