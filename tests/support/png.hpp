// Decodes PNG pictures: palette or RGBA, all filters, not interlaced. REQUIREs that the file keeps every rule: order
// and CRCs of chunks, a zlib stream that zlib itself inflates (with its Adler-32), and no byte too many.
#pragma once
#include "store/text/color.hpp"
#include "tests/support/test.hpp"

namespace teracell::testing {

struct Decoded {
  uint32_t width = 0, height = 0;
  int bits = 0, kind = 0;  // of a sample; 3 is a palette, 6 RGBA
  size_t data_chunks = 0, alphas = 0;
  std::vector<Rgba> palette;
  std::vector<std::vector<Rgba>> rows;
};
Decoded decode(std::span<const uint8_t> png);

// The pixels alone, row by row from the top.
struct Png {
  int64_t width = 0, height = 0;
  std::vector<Rgba> pixels;
};
Png png_of(const std::string& bytes);

}  // namespace teracell::testing
