// Writes a zlib stream (RFC 1950, 1951) for a caller that knows where its bytes repeat: literals, and matches at two distances
// that are fixed for the whole stream. It searches for nothing and keeps no window. Each block has its own Huffman code. A
// distance costs one bit, plus the extra bits that RFC 1951 gives to it.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

#include "store/base/bytes.hpp"

namespace teracell::server {

class RunDeflate {
 public:
  using Sink = std::function<void(std::span<const uint8_t>)>;
  static constexpr uint64_t kFarthest = 32768, kLeastMatch = 3;
  enum Back { kNear = 0, kFar = 1 };

  // `sink` gets the stream in pieces of 64 KiB to 256 KiB; the last one may be shorter. REQUIRES: 1 <= near < far <= kFarthest.
  RunDeflate(uint32_t near, uint32_t far, Sink sink);
  void literal(uint8_t byte) { put(byte); }
  // Repeats `length` bytes from `near` or `far` bytes before. REQUIRES: length >= kLeastMatch, and the stream has that many bytes
  // before.
  void match(Back back, uint64_t length);
  // REQUIRES: the stream is not empty; `adler` is the Adler-32 of all its bytes.
  void finish(uint32_t adler);

 private:
  // A token is a literal, or a match: 256 * (1 + Back) + length - kLeastMatch.
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
  std::unique_ptr<uint16_t[]> tokens_;  // of the next block
  uint32_t filled_ = 0;
  Bytes out_;
  uint64_t bits_ = 0;  // pending_ bits, fewer than 8, that are not in out_ yet
  uint32_t pending_ = 0;
};

}  // namespace teracell::server
