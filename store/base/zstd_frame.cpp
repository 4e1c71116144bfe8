#include "store/base/zstd_frame.hpp"

#include <memory>
#include <new>

#include <fmt/format.h>
#include <zstd.h>

namespace teracell::inline store {
namespace {

template <class T>
T* made(T* context) {
  if (context == nullptr) throw std::bad_alloc();
  return context;
}

// What the frame says of its body's size, if it may be so.
size_t body_size(std::span<const uint8_t> frame, const BodyBound& bound, const std::string& what) {
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size())
    throw FormatError(what + ": expected one zstd frame with its content size, found something else (FORMAT.md 1.3)");
  if (const uint64_t most = bound.of(frame.size()); size > most)
    throw FormatError(fmt::format("{}: expected a zstd frame of at most {} bytes, as its own size is {}, found {} (FORMAT.md 3.1)", what, most,
                                  frame.size(), size));
  return size;
}

}  // namespace

size_t zstd_frame_size(std::span<const uint8_t> bytes) {
  const size_t size = ZSTD_findFrameCompressedSize(bytes.data(), bytes.size());
  return ZSTD_isError(size) ? 0 : size;
}

ZstdEncoder::ZstdEncoder() : zstd_(made(ZSTD_createCCtx())) {}
ZstdEncoder::~ZstdEncoder() { ZSTD_freeCCtx(zstd_); }

Bytes ZstdEncoder::encode(std::span<const uint8_t> body, int level) {
  const size_t most = ZSTD_compressBound(body.size());
  const auto frame = std::make_unique_for_overwrite<uint8_t[]>(most);  // the memory behind the frame is never touched
  const size_t size = ZSTD_compressCCtx(zstd_, frame.get(), most, body.data(), body.size(), level);
  if (ZSTD_isError(size)) throw Error(fmt::format("zstd: {}", ZSTD_getErrorName(size)));
  return {frame.get(), frame.get() + size};
}

Bytes ZstdEncoder::encode(std::span<const uint8_t> body, int level, const BodyBound& bound) {
  Bytes frame = encode(body, level);
  // Level -n leaves n bytes of each 128 KiB as they are.
  for (const int plain : {-550, -1000})
    if (body.size() > bound.of(frame.size())) frame = encode(body, plain);
  return frame;
}

ZstdDecoder::ZstdDecoder() : zstd_(made(ZSTD_createDCtx())) {}
ZstdDecoder::~ZstdDecoder() { ZSTD_freeDCtx(zstd_); }

void ZstdDecoder::decode(std::span<const uint8_t> frame, const BodyBound& bound, const std::string& what, Bytes& body) {
  body.resize(body_size(frame, bound, what));
  decode_into(frame, what, body);
}

void ZstdDecoder::append(std::span<const uint8_t> frame, const BodyBound& bound, const std::string& what, std::string& text) {
  constexpr size_t kRoomBehind = 4096;  // appending to a full text would double it
  const size_t before = text.size(), size = body_size(frame, bound, what);
  text.reserve(before + size + kRoomBehind);
  text.resize(before + size);
  decode_into(frame, what, {reinterpret_cast<uint8_t*>(text.data()) + before, size});
}

void ZstdDecoder::decode_into(std::span<const uint8_t> frame, const std::string& what, std::span<uint8_t> body) {
  const size_t found = ZSTD_decompressDCtx(zstd_, body.data(), body.size(), frame.data(), frame.size());
  if (ZSTD_isError(found) || found != body.size())
    throw FormatError(fmt::format("{}: zstd says {} (FORMAT.md 1.3)", what, ZSTD_isError(found) ? ZSTD_getErrorName(found) : "too short"));
}

}  // namespace teracell::store
