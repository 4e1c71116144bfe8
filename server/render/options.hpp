// The options of a picture as people write them, on the command line and in addresses alike.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "server/render/render.hpp"

namespace teracell::server {

struct RenderOption {
  std::string_view name, value, help;  // without a value it is a flag
};
std::span<const RenderOption> render_options();

// The text of an option, or null when it is not given. That of a flag is "" or "1".
using OptionText = std::function<const std::string*(std::string_view name)>;
// Throws UsageError, which calls an option by `dashes` and its name.
RenderOptions parse_render_options(const OptionText& text, const GridReader& reader, std::string_view dashes);

}  // namespace teracell::server
