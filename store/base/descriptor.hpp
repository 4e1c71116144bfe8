// An open file of the operating system.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

namespace teracell::inline store {

class Descriptor {
 public:
  explicit Descriptor(int fd = -1) : fd_(fd) {}
  Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(fd_, other.fd_);
    return *this;
  }
  ~Descriptor() { close(); }
  void close();
  explicit operator bool() const { return fd_ >= 0; }
  int get() const { return fd_; }

  // These return how many bytes they did. If that is not all, errno says why; it is 0 where the file ends.
  size_t read(uint64_t offset, std::span<uint8_t> out) const;
  size_t write(uint64_t offset, std::span<const uint8_t> bytes) const;
  bool append(std::span<const uint8_t> bytes) const;  // all, or errno says why not

 private:
  int fd_;
};

// Throws IoError.
[[noreturn]] void fail_at(const std::filesystem::path& where, const char* what, int error);

}  // namespace teracell::store
