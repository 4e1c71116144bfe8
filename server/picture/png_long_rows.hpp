// PNGs whose rows are too long to keep in memory. Numbers come in parts of a row and leave as chunks. No row is compared with the
// one above, so zlib compresses them.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "server/picture/png_file.hpp"

namespace teracell::server {

// Memory: a few hundred kB, whatever the picture's size.
class PngLongRows {
 public:
  PngLongRows(uint32_t width, uint32_t height, std::span<const Rgba> palette, PngFile::Sink sink);
  ~PngLongRows();
  PngLongRows(const PngLongRows&) = delete;
  // The next pixels of a row. `value` has an entry for each number, as for PngFile::pack(). REQUIRES: the row doesn't get too long.
  void append(std::span<const uint16_t> numbers, const uint32_t* value);
  void finish();  // REQUIRES: height rows were written

 private:
  struct Stream;
  void put(std::span<const uint8_t> bytes, bool last = false);
  PngFile file_;
  const uint32_t width_;
  uint32_t at_ = 0;              // pixels of the row so far
  std::vector<uint16_t> group_;  // the last of them, fewer than 8, that are not packed yet
  std::unique_ptr<Stream> stream_;
};

}  // namespace teracell::server
