// The colour of a material as scenes and files write it: "#rrggbb" or "#rrggbbaa", sRGB, straight alpha.
#pragma once
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace teracell::inline store {

using Rgba = std::array<uint8_t, 4>;

inline std::optional<Rgba> parse_color(std::string_view text) {
  if ((text.size() != 7 && text.size() != 9) || text[0] != '#') return std::nullopt;
  Rgba color = {0, 0, 0, 255};
  for (size_t i = 1; i < text.size(); i += 2) {
    const char* const end = text.data() + i + 2;
    const auto [stop, error] = std::from_chars(end - 2, end, color[i / 2], 16);
    if (stop != end || error != std::errc{}) return std::nullopt;
  }
  return color;
}

// The default colour of material `id` >= 1: seven colours that colour-blind readers can tell apart, then darker shades of them.
std::string palette_color(uint32_t id);

}  // namespace teracell::store
