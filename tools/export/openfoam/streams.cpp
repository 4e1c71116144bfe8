#include "tools/export/openfoam/streams.hpp"

#include <fcntl.h>

#include <algorithm>
#include <cerrno>

#include "store/base/descriptor.hpp"

namespace teracell::exports::foam {
namespace {

constexpr size_t kLeast = 1 << 10, kMost = 1 << 18, kAllStreams = 48 << 20;

}  // namespace

void write_at(const std::filesystem::path& file, uint64_t at, std::span<const uint8_t> bytes) {
  const Descriptor out(::open(file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666));
  if (!out || out.write(at, bytes) < bytes.size()) fail_at(file, "can't write", errno);
}

void Stream::flush() {
  write_at(*place_.file, place_.at, {buffer_.get(), size_});
  place_.at += size_;
  size_ = 0;
}

void Stream::release() {
  if (capacity_ == 0) return;
  all_.bytes_ -= capacity_;
  std::erase(all_.buffered_, this);
  buffer_.reset();
  size_ = capacity_ = 0;
}

void Stream::close() {
  if (size_ > 0) flush();
  release();
}

// A buffer grows while all of them leave room for it. When they don't, all are written, the small ones too: which stream will be
// written to next is not known.
void Stream::make_room() {
  if (capacity_ == kMost) return flush();
  if (all_.bytes_ + kMost > kAllStreams)
    while (!all_.buffered_.empty()) all_.buffered_.back()->close();
  const size_t larger = std::max(kLeast, 4 * capacity_);
  auto buffer = std::make_unique<uint8_t[]>(larger);
  if (size_ > 0) std::memcpy(buffer.get(), buffer_.get(), size_);
  if (capacity_ == 0) all_.buffered_.push_back(this);
  all_.bytes_ += larger - capacity_;
  buffer_ = std::move(buffer);
  capacity_ = larger;
}

}  // namespace teracell::exports::foam
