// Many places in many files that are written to in turn. What is put is kept in buffers, which together have a bounded size; no file is
// open but while bytes are written.
#pragma once
#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace teracell::exports::foam {

class Stream;

// The streams that have a buffer. It must outlive them. Not thread-safe.
class Streams {
  friend class Stream;
  std::vector<Stream*> buffered_;
  size_t bytes_ = 0;
};

struct Place {
  std::shared_ptr<const std::filesystem::path> file;
  uint64_t at;
};

// Bytes that follow each other from a place of a file on. Destroyed without close(), it forgets what is not written yet.
class Stream {
 public:
  Stream(Streams& all, Place place) : all_(all), place_(std::move(place)) {}
  Stream(const Stream&) = delete;
  ~Stream() { release(); }
  // REQUIRES: T is small and has no padding. Little endian, like every machine this runs on.
  template <class T>
  void put(const T& value) {
    if (capacity_ - size_ < sizeof(T)) make_room();
    std::memcpy(buffer_.get() + size_, &value, sizeof(T));
    size_ += sizeof(T);
  }
  template <class T>
  void put_all(const std::vector<T>& values) {
    for (std::span<const T> rest(values); !rest.empty();) {
      if (capacity_ - size_ < sizeof(T)) make_room();
      const auto fit = rest.first(std::min(rest.size(), (capacity_ - size_) / sizeof(T)));
      std::memcpy(buffer_.get() + size_, fit.data(), fit.size_bytes());
      size_ += fit.size_bytes();
      rest = rest.subspan(fit.size());
    }
  }
  // Writes what was put.
  void close();

 private:
  void make_room();
  void flush();
  void release();

  Streams& all_;
  Place place_;
  std::unique_ptr<uint8_t[]> buffer_;
  size_t size_ = 0, capacity_ = 0;
};

// Writes bytes at a place of a file, which is made if it is not there. Throws IoError.
void write_at(const std::filesystem::path& file, uint64_t at, std::span<const uint8_t> bytes);

}  // namespace teracell::exports::foam
