// PNG pictures back to pixels: palette or RGBA, filters "none" and "up", not interlaced. Holds the file against every rule on
// the way: order and CRCs of chunks, zlib's own inflate with its Adler-32, no byte too many.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "store/color.hpp"

namespace teracell::testing {

struct Decoded {
  uint32_t width = 0, height = 0;
  int bits = 0, kind = 0;  // of a sample; 3 is a palette, 6 RGBA
  size_t data_chunks = 0, alphas = 0;
  std::vector<Rgba> palette;
  std::vector<std::vector<Rgba>> rows;
};
Decoded decode(std::span<const uint8_t> png);

}  // namespace teracell::testing
