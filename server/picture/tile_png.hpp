// Encodes a whole picture of labels in memory as PNG: the server's tiles.
//
// Why not a library: a compressor searches for repeats that are known from the rows already (png_rows.hpp). The table has time and
// size of other encoders as multiples of ours, measured on a busy machine with tools/bench/peers/png_peer. Tiles are 512 x 512. "statue"
// is the mean of 12 tiles with its surface (2 materials; ours takes 0.04 ms and 0.6 kB), "stadium" that of 10 tiles (4; 0.05 ms,
// 0.9 kB), then a tile of one material (0.02 ms, 0.2 kB). The last two are bad for us: rings with 34 boundaries in a row (2;
// 0.36 ms, 14 kB), and noise (7; 1.2 ms, 94 kB).
//
//                                            statue      stadium     one material     rings        noise
//   libdeflate-1, fewest bits, no filter    4.1  1.6    5.9  1.3     8.1  1.3      0.4  0.5     1.1  1.0
//   libdeflate-2, fewest bits, no filter    3.6  1.6    4.9  1.2     6.6  1.3      0.6  0.4     1.4  1.0
//   libdeflate-2, fewest bits, "up"         3.6  1.7    5.0  1.6     6.4  1.3      1.0  0.9     1.5  1.2
//   libdeflate-1, 8 bits, no filter          20  3.4     16  2.6      38  6.3      1.8  1.7     1.0  1.2
//   zlib's runs, fewest bits, "up"          2.9  2.0    4.6  1.7     5.0  3.6      0.8  1.2     1.2  1.2
//   stb_image_write, grey, libdeflate-1      25  3.3     20  2.6      53  6.2      2.4  1.7     1.1  1.2
//   libspng-1, 8 bits                        11  4.5     19  3.7      20  8.9      3.0  1.9     3.2  1.2
//   libspng-6, 8 bits                        33  2.8     30  1.7      41  6.3       14  1.0      57  1.1
//
// Where boundaries are only a few cells apart, a search finds more than the row above has: libdeflate then takes half our time and
// half our bytes (for noise of 2 materials, half our time). For the busiest of the 22 tiles, with 7,500 changes between
// neighbours, we still take less than half of libdeflate's time, for the same size.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "store/text/color.hpp"

namespace teracell::server {

// `numbers` are the pixels row by row from the top, each below colors.size(). The colours that occur are the palette; when there
// are more than 256, the picture is RGBA. REQUIRES: width, height >= 1; width * height numbers. Threads may call it at once.
std::string encode_png(uint32_t width, uint32_t height, std::span<const uint16_t> numbers, std::span<const Rgba> colors);

}  // namespace teracell::server
