// A zlib stream (RFC 1950, 1951) for those who know where their bytes repeat: literals, and matches at two distances that
// are fixed for the whole stream. Nothing is searched for, no window is kept. Each block has its own Huffman code; both
// distances cost one bit and what RFC 1951 adds to a distance.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "store/bytes.hpp"

namespace teracell {

class RunDeflate {
 public:
  using Sink = std::function<void(std::span<const uint8_t>)>;
  static constexpr uint64_t kFarthest = 32768, kLeastMatch = 3;
  enum Back { kNear = 0, kFar = 1 };

  // REQUIRES: 1 <= near < far <= kFarthest. The stream comes to `sink` in pieces of 64 KiB to 256 KiB, the last one shorter.
  RunDeflate(uint32_t near, uint32_t far, Sink sink);
  void literal(uint8_t byte) { put(byte); }
  // `length` bytes as they stand `near` or `far` bytes before. REQUIRES: length >= kLeastMatch, so many bytes were written.
  void match(Back back, uint64_t length);
  // REQUIRES: something was written; `adler` is the Adler-32 of all of it.
  void finish(uint32_t adler);

 private:
  // A token is a literal, or 256 times (1 + Back) and the length without its least.
  static constexpr uint32_t kTokens = 3 * 256, kBlock = 1 << 15;
  struct Distance {
    uint32_t symbol, bits, extra;
    explicit Distance(uint32_t distance);
  };
  void put(uint32_t token) {
    if (filled_ == kBlock) write_block(false);
    tokens_[filled_++] = static_cast<uint16_t>(token);
  }
  void put_bits(uint64_t value, uint32_t count);
  void put_codes(std::span<const uint8_t> literals);
  void write_block(bool last);

  const std::array<Distance, 2> distance_;
  Sink sink_;
  std::unique_ptr<uint16_t[]> tokens_;  // of the block to come
  uint32_t filled_ = 0;
  Bytes out_;
  uint64_t bits_ = 0;  // fewer than 8 that are not in out_ yet
  uint32_t pending_ = 0;
};

}  // namespace teracell
