// zstd frames as FORMAT.md defines them: with the content size in the header, and nothing behind the frame. For the store's
// own sources.
#pragma once
#include <string>

#include "store/bytes.hpp"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace teracell {

// Keeps scratch memory between calls: each thread has its own.
class ZstdEncoder {
 public:
  ZstdEncoder();
  ~ZstdEncoder();
  ZstdEncoder(const ZstdEncoder&) = delete;
  Bytes encode(std::span<const uint8_t> body, int level);

 private:
  ZSTD_CCtx_s* zstd_;
};

// Keeps scratch memory between calls: each thread has its own.
class ZstdDecoder {
 public:
  ZstdDecoder();
  ~ZstdDecoder();
  ZstdDecoder(const ZstdDecoder&) = delete;
  // Throws FormatError, naming `what`, unless `frame` is one frame of a body of at most `most` bytes.
  void decode(std::span<const uint8_t> frame, uint64_t most, const std::string& what, Bytes& body);
  // The same, but the body is appended to a text. There is room for a little more behind it.
  void append(std::span<const uint8_t> frame, uint64_t most, const std::string& what, std::string& text);

 private:
  void decode_into(std::span<const uint8_t> frame, const std::string& what, std::span<uint8_t> body);
  ZSTD_DCtx_s* zstd_;
};

}  // namespace teracell
