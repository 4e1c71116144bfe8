// A whole picture of labels, in memory, as PNG: what the server's tiles are.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "store/color.hpp"

namespace teracell {

// `numbers` row by row from the top, each below colors.size(). The colours that occur are the palette; past 256 of them the
// picture is RGBA. REQUIRES: width, height >= 1, width * height numbers. Threads may call it at once.
std::string encode_png(uint32_t width, uint32_t height, std::span<const uint16_t> numbers, std::span<const Rgba> colors);

}  // namespace teracell
