// Writes pictures of labels as PNG: rows of numbers come in, chunks go out. The time depends on what changes from one row to the
// next. Stretches that equal the row above become DEFLATE matches at the distance of one row, filter byte included; they are never
// packed, compared as bytes, summed or searched. Only groups of 8 numbers that differ are looked at.
//
// DEFLATE reaches back 32 kB. Rows longer than that are written as runs of differences to the row above (filter "up").
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "server/picture/png_file.hpp"
#include "server/picture/run_deflate.hpp"

namespace teracell::server {

// Appends the groups of 8 numbers in which a row differs from the one above; all groups when `above` is empty.
void append_changes(std::span<const uint16_t> above, std::span<const uint16_t> row, std::vector<uint32_t>& groups);

// Memory: one row and a few hundred kB.
class PngRows {
 public:
  PngRows(uint32_t width, uint32_t height, std::span<const Rgba> palette, PngFile::Sink sink);
  PngRows(const PngRows&) = delete;
  // The next row from the top. `changed` comes from append_changes(). `value` has an entry for each number, as for PngFile::pack().
  void row(std::span<const uint16_t> numbers, std::span<const uint32_t> changed, const uint32_t* value);
  void repeat();  // the row above once more. REQUIRES: there is one
  void finish();  // REQUIRES: height rows were written

 private:
  void add_to_adler();
  void same(uint64_t at, uint64_t length);
  void byte(uint64_t at, uint8_t value, int64_t weight);
  void extend(RunDeflate::Back back, uint64_t at, uint64_t length);
  void flush(uint64_t at);

  PngFile file_;
  const uint32_t bits_;       // per pixel
  const uint64_t length_;     // bytes of a row, with its filter byte
  const int64_t length_weight_;  // the same, modulo the base of Adler-32
  const bool matches_above_;  // false: rows are written as differences
  const uint32_t near_;       // distance of runs
  bool first_ = true;         // whether the next row is the first
  RunDeflate deflate_;
  std::vector<uint8_t> line_;  // the unfiltered row, filter byte first
  uint8_t last_ = 0;           // the last difference that was written
  RunDeflate::Back back_{};    // the distance and length of the match so far
  uint64_t match_ = 0;
  // Adler-32 is updated once per row, from the sum of its bytes and the sum in which each byte is weighted by the number of bytes
  // from it to the row's end, itself included. Both sums are adjusted for the bytes that change.
  int64_t sum_ = 0, weighted_ = 0;
  int64_t adler_a_ = 1, adler_b_ = 0;
};

}  // namespace teracell::server
