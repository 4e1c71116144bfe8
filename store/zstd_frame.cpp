#include "store/zstd_frame.hpp"

#include <memory>
#include <new>

#include <fmt/format.h>
#include <zstd.h>

namespace teracell {
namespace {

constexpr uint64_t kMaxRatio = 1 << 15;  // a zstd block of 4 bytes holds at most 128 KiB

template <class T>
T* made(T* context) {
  if (context == nullptr) throw std::bad_alloc();
  return context;
}

}  // namespace

ZstdEncoder::ZstdEncoder() : zstd_(made(ZSTD_createCCtx())) {}
ZstdEncoder::~ZstdEncoder() { ZSTD_freeCCtx(zstd_); }

Bytes ZstdEncoder::encode(std::span<const uint8_t> body, int level) {
  const size_t most = ZSTD_compressBound(body.size());
  const auto frame = std::make_unique_for_overwrite<uint8_t[]>(most);  // the memory behind the frame is never touched
  const size_t size = ZSTD_compressCCtx(zstd_, frame.get(), most, body.data(), body.size(), level);
  if (ZSTD_isError(size)) throw Error(fmt::format("zstd: {}", ZSTD_getErrorName(size)));
  return {frame.get(), frame.get() + size};
}

ZstdDecoder::ZstdDecoder() : zstd_(made(ZSTD_createDCtx())) {}
ZstdDecoder::~ZstdDecoder() { ZSTD_freeDCtx(zstd_); }

void ZstdDecoder::decode(std::span<const uint8_t> frame, uint64_t most, const std::string& what, Bytes& body) {
  const unsigned long long size = ZSTD_getFrameContentSize(frame.data(), frame.size());
  if (size == ZSTD_CONTENTSIZE_ERROR || size == ZSTD_CONTENTSIZE_UNKNOWN || size > most || size > kMaxRatio * frame.size() ||
      ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size())
    throw FormatError(what + ": expected one zstd frame with its content size, found something else");
  body.resize(size);
  const size_t found = ZSTD_decompressDCtx(zstd_, body.data(), body.size(), frame.data(), frame.size());
  if (ZSTD_isError(found) || found != size)
    throw FormatError(fmt::format("{}: zstd says {}", what, ZSTD_isError(found) ? ZSTD_getErrorName(found) : "too short"));
}

}  // namespace teracell
