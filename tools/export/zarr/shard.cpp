#include "tools/export/zarr/shard.hpp"

#include <boost/crc.hpp>

namespace teracell::exports::zarr {
uint32_t crc32c(std::span<const uint8_t> bytes) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
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

}  // namespace teracell::exports::zarr
