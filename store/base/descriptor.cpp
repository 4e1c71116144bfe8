#include "store/base/descriptor.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <unistd.h>

#include "store/base/error.hpp"

namespace teracell::inline store {
namespace {

// some(done) does some of the bytes that are left, and returns how many, 0 at the end, or -1 with errno.
template <class Some>
size_t in_pieces(size_t size, Some some) {
  size_t done = 0;
  while (done < size) {
    const ssize_t n = some(done);
    if (n < 0 && errno == EINTR) continue;
    if (n == 0) errno = 0;
    if (n <= 0) break;
    done += static_cast<size_t>(n);
  }
  return done;
}

}  // namespace

void Descriptor::close() {
  if (fd_ >= 0) ::close(std::exchange(fd_, -1));
}

size_t Descriptor::read(uint64_t offset, std::span<uint8_t> out) const {
  return in_pieces(out.size(), [&](size_t done) { return ::pread(fd_, out.data() + done, out.size() - done, static_cast<off_t>(offset + done)); });
}

size_t Descriptor::write(uint64_t offset, std::span<const uint8_t> bytes) const {
  return in_pieces(bytes.size(),
                   [&](size_t done) { return ::pwrite(fd_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done)); });
}

bool Descriptor::append(std::span<const uint8_t> bytes) const {
  return in_pieces(bytes.size(), [&](size_t done) { return ::write(fd_, bytes.data() + done, bytes.size() - done); }) == bytes.size();
}

void fail_at(const std::filesystem::path& where, const char* what, int error) {
  throw IoError(fmt::format("{}: {}: {}", where.string(), what, std::strerror(error)), error);
}

}  // namespace teracell::store
