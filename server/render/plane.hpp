// A plane as people write it, on the command line and in addresses alike, and the picture of the cells that it meets.
#pragma once
#include "server/render/options.hpp"
#include "store/read/plane.hpp"

namespace teracell::server {

// The options of such a picture. `plane` is one of three things, by how many numbers it has: a normal and an offset, the angles of a normal and a
// point, or three points, which go round counterclockwise as they are seen. The picture is seen from where the normal points; z is up, or y where the
// normal is along z.
std::span<const RenderOption> plane_options();

// The whole of the picture. Throws UsageError, which calls an option by `dashes` and its name. REQUIRES: text("plane").
PlaneView parse_plane_view(const OptionText& text, const Grid& grid, std::string_view dashes);

}  // namespace teracell::server
