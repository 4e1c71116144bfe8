// The index at the end of a shard of Zarr 3 ("sharding_indexed"): where each chunk lies, and a checksum.
#pragma once
#include "store/base/bytes.hpp"

namespace teracell::exports::zarr {

// CRC-32C (Castagnoli), as in iSCSI: RFC 3720, B.4.
uint32_t crc32c(std::span<const uint8_t> bytes);

class ShardIndex {
 public:
  explicit ShardIndex(size_t chunks) : places_(chunks) {}
  void put(size_t chunk, uint64_t offset, uint64_t bytes) { places_[chunk] = {offset, bytes}; }
  Bytes encode() const;

 private:
  struct Place {
    uint64_t offset = ~uint64_t{0}, bytes = ~uint64_t{0};  // this says that there is no such chunk
  };
  std::vector<Place> places_;
};

}  // namespace teracell::exports::zarr
