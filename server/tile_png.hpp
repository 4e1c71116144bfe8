// A whole picture as PNG, in memory.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "store/color.hpp"

namespace teracell {

// Numbers row by row from the top, each below colors.size().
std::string encode_png(uint32_t width, uint32_t height, std::span<const uint16_t> numbers, std::span<const Rgba> colors);

}  // namespace teracell
