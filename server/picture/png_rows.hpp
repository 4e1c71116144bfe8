// The PNG format, for pictures of labels: rows of numbers in, chunks out. What a picture costs is what changes from a row
// to the next: stretches as in the row above are DEFLATE matches at the distance of a row, filter bytes included, and are
// never packed, compared as bytes, summed or searched. Only groups of 8 numbers that differ are looked at.
//
// Rows too long for such a distance (32 kB) are written as differences to the row above (filter "up"), in runs.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "server/picture/png_file.hpp"
#include "server/picture/run_deflate.hpp"

namespace teracell {

// Appends the groups of 8 numbers that differ between a row and the one above; all when there is none above.
void append_changes(std::span<const uint16_t> above, std::span<const uint16_t> row, std::vector<uint32_t>& groups);

// Memory: a row and a few hundred kB.
class PngRows {
 public:
  PngRows(uint32_t width, uint32_t height, std::span<const Rgba> palette, PngFile::Sink sink);
  PngRows(const PngRows&) = delete;
  // The next row from the top. `changed`: of append_changes. `value`: of each number, for PngFile::pack().
  void row(std::span<const uint16_t> numbers, std::span<const uint32_t> changed, const uint32_t* value);
  void finish();  // REQUIRES: height rows were written

 private:
  void same(uint64_t at, uint64_t length);
  void byte(uint64_t at, uint8_t value, int64_t weight);
  void extend(RunDeflate::Back back, uint64_t at, uint64_t length);
  void flush(uint64_t at);

  PngFile file_;
  const uint32_t bits_;       // a pixel
  const uint64_t length_;     // of a row, with its filter byte
  const bool matches_above_;  // else rows are differences
  const uint32_t near_;       // distance of runs
  bool first_ = true;         // row
  RunDeflate deflate_;
  std::vector<uint8_t> line_;  // the row as it is now, filter byte first: unfiltered
  uint8_t last_ = 0;           // byte written, of differences
  RunDeflate::Back back_{};    // what match is going on, and how many bytes of it were met
  uint64_t match_ = 0;
  // Adler-32, a row at a time: its bytes' sum, and the sum by how many bytes follow to the row's end, itself included.
  // Both change by what changes in the row.
  int64_t sum_ = 0, weighted_ = 0;
  int64_t adler_a_ = 1, adler_b_ = 0;
};

}  // namespace teracell
