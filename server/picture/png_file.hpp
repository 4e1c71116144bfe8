// What surrounds the rows of every PNG that we write (header, palette, chunks with their CRCs), and how pixels are packed.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <span>

#include "store/text/color.hpp"

namespace teracell::server {

// A pixel takes as few bits as the size of `palette` allows: 1, 2, 4 or 8. With an empty palette the picture is RGBA.
class PngFile {
 public:
  using Sink = std::function<void(std::span<const uint8_t>)>;
  static constexpr size_t kMostColors = 256;  // of a palette

  // REQUIRES: 1 to 2^31 - 1 pixels each way.
  PngFile(uint32_t width, uint32_t height, std::span<const Rgba> palette, Sink sink);
  uint32_t bits() const { return bits_; }  // of a pixel: 1, 2, 4, 8 with a palette, 32 without
  void data(std::span<const uint8_t> zlib) { chunk("IDAT", zlib); }
  void finish() { chunk("IEND", {}); }

  // Packs 8 pixels; the first bits() bytes of the result are used. `value` has for each number its place in the palette, or without
  // a palette its colour as rgba().
  std::array<uint8_t, 32> pack(const uint16_t* numbers, const uint32_t* value) const {
    std::array<uint8_t, 32> bytes;
    if (bits_ == 32) {
      for (uint32_t i = 0; i < 32; ++i) bytes[i] = static_cast<uint8_t>(value[numbers[i / 4]] >> (8 * (i % 4)));
    } else {
      uint64_t word = 0;
      for (uint32_t i = 0; i < 8; ++i) word = word << bits_ | value[numbers[i]];
      for (uint32_t i = 0; i < bits_; ++i) bytes[i] = static_cast<uint8_t>(word >> (8 * (bits_ - 1 - i)));
    }
    return bytes;
  }
  static uint32_t rgba(const Rgba& c) { return c[0] | uint32_t{c[1]} << 8 | uint32_t{c[2]} << 16 | uint32_t{c[3]} << 24; }

 private:
  void chunk(const char* type, std::span<const uint8_t> data);
  Sink sink_;
  const uint32_t bits_;
};

}  // namespace teracell::server
