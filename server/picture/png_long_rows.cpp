#include "server/picture/png_long_rows.hpp"

#include <algorithm>
#include <new>

#include <zlib.h>

#include "store/base/bytes.hpp"

namespace teracell::server {

struct PngLongRows::Stream {
  z_stream z{};
  Bytes in, out;  // packed pixels that are not compressed yet; room for compressed bytes
  explicit Stream(int strategy) : out(1 << 16) {
    if (deflateInit2(&z, Z_BEST_SPEED, Z_DEFLATED, 15, 8, strategy) != Z_OK) throw std::bad_alloc();
  }
  ~Stream() { deflateEnd(&z); }
};

PngLongRows::PngLongRows(uint32_t width, uint32_t height, std::span<const Rgba> palette, PngFile::Sink sink)
    : file_(width, height, palette, std::move(sink)),
      width_(width),
      stream_(std::make_unique<Stream>(file_.bits() == 32 ? Z_DEFAULT_STRATEGY : Z_RLE)) {}

PngLongRows::~PngLongRows() = default;

void PngLongRows::append(std::span<const uint16_t> numbers, const uint32_t* value) {
  Bytes& in = stream_->in;
  const auto pack = [&](const uint16_t* group, size_t bytes) {
    const auto packed = file_.pack(group, value);
    in.insert(in.end(), packed.begin(), packed.begin() + static_cast<ptrdiff_t>(bytes));
  };
  if (at_ == 0) in.push_back(0);  // filter byte: "none"
  at_ += static_cast<uint32_t>(numbers.size());
  const auto fill = [&](size_t count) {
    group_.insert(group_.end(), numbers.begin(), numbers.begin() + static_cast<ptrdiff_t>(count));
    numbers = numbers.subspan(count);
  };
  if (!group_.empty()) fill(std::min(numbers.size(), 8 - group_.size()));
  if (group_.size() == 8) pack(group_.data(), file_.bits()), group_.clear();
  for (; numbers.size() >= 8; numbers = numbers.subspan(8)) {
    pack(numbers.data(), file_.bits());
    if (in.size() >= 1 << 16) put(in), in.clear();
  }
  fill(numbers.size());
  if (at_ < width_) return;
  at_ = 0;
  if (group_.empty()) return;
  const size_t bytes = (group_.size() * file_.bits() + 7) / 8;
  group_.resize(8, group_.back());
  pack(group_.data(), bytes);
  group_.clear();
}

void PngLongRows::finish() {
  put(stream_->in, true);
  file_.finish();
}

void PngLongRows::put(std::span<const uint8_t> bytes, bool last) {
  z_stream& z = stream_->z;
  z.next_in = const_cast<Bytef*>(bytes.data());
  z.avail_in = static_cast<uInt>(bytes.size());
  do {
    z.next_out = stream_->out.data();
    z.avail_out = static_cast<uInt>(stream_->out.size());
    deflate(&z, last ? Z_FINISH : Z_NO_FLUSH);
    const size_t made = stream_->out.size() - z.avail_out;
    if (made > 0) file_.data({stream_->out.data(), made});
  } while (z.avail_out == 0);
}

}  // namespace teracell::server
