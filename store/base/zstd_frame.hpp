// zstd frames as FORMAT.md defines them: with the content size in the header, and nothing behind the frame. For the store's
// own sources.
#pragma once
#include <algorithm>
#include <string>

#include "store/base/bytes.hpp"

struct ZSTD_CCtx_s;
struct ZSTD_DCtx_s;

namespace teracell::inline store {

// How long the body of a frame may be (FORMAT.md, "Bounds"): at most `most` bytes; beyond `of_any_frame` at most 256 times as long
// as the frame. So a small file can't ask for much memory or time.
struct BodyBound {
  uint64_t most, of_any_frame;
  uint64_t of(uint64_t frame_bytes) const { return std::min(most, std::max(of_any_frame, 256 * frame_bytes)); }
};

// The bytes of the zstd frame that `bytes` begin with; 0 if they don't.
size_t zstd_frame_size(std::span<const uint8_t> bytes);

// Keeps scratch memory between calls: each thread has its own.
class ZstdEncoder {
 public:
  ZstdEncoder();
  ~ZstdEncoder();
  ZstdEncoder(const ZstdEncoder&) = delete;
  Bytes encode(std::span<const uint8_t> body, int level);
  // Compresses less where the frame would be too small for its body. REQUIRES: the body has at most bound.most bytes.
  Bytes encode(std::span<const uint8_t> body, int level, const BodyBound& bound);

 private:
  ZSTD_CCtx_s* zstd_;
};

// Keeps scratch memory between calls: each thread has its own.
class ZstdDecoder {
 public:
  ZstdDecoder();
  ~ZstdDecoder();
  ZstdDecoder(const ZstdDecoder&) = delete;
  // Throws FormatError, naming `what`, unless `frame` is one frame whose body is within the bound.
  void decode(std::span<const uint8_t> frame, const BodyBound& bound, const std::string& what, Bytes& body);
  // The same, but the body is appended to a text. There is room for a little more behind it.
  void append(std::span<const uint8_t> frame, const BodyBound& bound, const std::string& what, std::string& text);

 private:
  void decode_into(std::span<const uint8_t> frame, const std::string& what, std::span<uint8_t> body);
  ZSTD_DCtx_s* zstd_;
};

}  // namespace teracell::store
