#include "server/tile_png.hpp"

#include <new>
#include <vector>

#include <zlib.h>

namespace teracell {
namespace {

void put_be32(std::string& out, uint32_t v) {
  for (int shift = 24; shift >= 0; shift -= 8) out += static_cast<char>(v >> shift);
}

void chunk(std::string& out, const std::string& type_and_data) {
  put_be32(out, static_cast<uint32_t>(type_and_data.size() - 4));
  out += type_and_data;
  put_be32(out, static_cast<uint32_t>(crc32(0, reinterpret_cast<const Bytef*>(type_and_data.data()), static_cast<uInt>(type_and_data.size()))));
}

}  // namespace

std::string encode_png(uint32_t width, uint32_t height, std::span<const uint16_t> numbers, std::span<const Rgba> colors) {
  const bool palette = colors.size() <= 256;
  std::string out = "\x89PNG\r\n\x1a\n", head = "IHDR";
  put_be32(head, width);
  put_be32(head, height);
  head += {8, static_cast<char>(palette ? 3 : 6), 0, 0, 0};
  chunk(out, head);
  if (palette) {
    std::string rgb = "PLTE", alpha = "tRNS";
    for (const Rgba& c : colors) {
      rgb.append({static_cast<char>(c[0]), static_cast<char>(c[1]), static_cast<char>(c[2])});
      alpha += static_cast<char>(c[3]);
    }
    chunk(out, rgb);
    chunk(out, alpha);
  }
  std::string raw;
  raw.reserve((size_t{width} * (palette ? 1 : 4) + 1) * height);
  for (size_t i = 0; i < numbers.size(); ++i) {
    if (i % width == 0) raw += '\0';
    if (palette) raw += static_cast<char>(numbers[i]);
    else
      for (const uint8_t channel : colors[numbers[i]]) raw += static_cast<char>(channel);
  }
  uLongf size = compressBound(raw.size());
  std::string data(size + 4, '\0');
  data.replace(0, 4, "IDAT");
  if (compress2(reinterpret_cast<Bytef*>(data.data() + 4), &size, reinterpret_cast<const Bytef*>(raw.data()), raw.size(), 1) != Z_OK) throw std::bad_alloc();
  data.resize(size + 4);
  chunk(out, data);
  chunk(out, "IEND");
  return out;
}

}  // namespace teracell
