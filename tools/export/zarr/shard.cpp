#include "tools/export/zarr/shard.hpp"

#include <array>

namespace teracell::zarr {
namespace {

constexpr std::array<uint32_t, 256> kRemainders = [] {
  std::array<uint32_t, 256> out{};
  for (uint32_t byte = 0; byte < 256; ++byte) {
    uint32_t r = byte;
    for (int bit = 0; bit < 8; ++bit) r = r >> 1 ^ (r & 1 ? 0x82f63b78u : 0);
    out[byte] = r;
  }
  return out;
}();

}  // namespace

uint32_t crc32c(std::span<const uint8_t> bytes) {
  uint32_t crc = ~uint32_t{0};
  for (const uint8_t byte : bytes) crc = crc >> 8 ^ kRemainders[(crc ^ byte) & 0xff];
  return ~crc;
}

Bytes ShardIndex::encode() const {
  Bytes out;
  out.reserve(16 * places_.size() + 4);
  for (const Place& place : places_) {
    put_fixed(out, place.offset);
    put_fixed(out, place.bytes);
  }
  put_fixed(out, crc32c(out));
  return out;
}

}  // namespace teracell::zarr
