#include "server/picture/png_file.hpp"

#include <zlib.h>

#include "store/base/bytes.hpp"

namespace teracell::server {
namespace {

void put_be32(Bytes& out, uint32_t v) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(static_cast<uint8_t>(v >> shift));
}

uint32_t bits_for(size_t colors) { return colors == 0 ? 32 : colors <= 2 ? 1 : colors <= 4 ? 2 : colors <= 16 ? 4 : 8; }

}  // namespace

PngFile::PngFile(uint32_t width, uint32_t height, std::span<const Rgba> palette, Sink sink)
    : sink_(std::move(sink)), bits_(bits_for(palette.size())) {
  constexpr uint8_t kSignature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  sink_(kSignature);
  Bytes header;
  put_be32(header, width);
  put_be32(header, height);
  const bool has_palette = bits_ <= 8;
  header.insert(header.end(), {static_cast<uint8_t>(has_palette ? bits_ : 8), static_cast<uint8_t>(has_palette ? 3 : 6), 0, 0, 0});
  chunk("IHDR", header);
  if (!has_palette) return;
  Bytes rgb, alpha;
  for (const Rgba& c : palette) {
    rgb.insert(rgb.end(), c.begin(), c.begin() + 3);
    alpha.push_back(c[3]);
  }
  chunk("PLTE", rgb);
  while (!alpha.empty() && alpha.back() == 255) alpha.pop_back();  // colours without an entry are opaque
  if (!alpha.empty()) chunk("tRNS", alpha);
}

void PngFile::chunk(const char* type, std::span<const uint8_t> data) {
  Bytes bytes;
  put_be32(bytes, static_cast<uint32_t>(data.size()));
  bytes.insert(bytes.end(), type, type + 4);
  sink_(bytes);
  sink_(data);
  uLong crc = crc32(0, reinterpret_cast<const Bytef*>(type), 4);
  crc = data.empty() ? crc : crc32(crc, data.data(), static_cast<uInt>(data.size()));
  bytes.clear();
  put_be32(bytes, static_cast<uint32_t>(crc));
  sink_(bytes);
}

}  // namespace teracell::server
