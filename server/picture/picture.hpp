// Pictures of label rows: PNG, streamed row by row, and the colours of sets.
#pragma once
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "server/picture/png_long_rows.hpp"
#include "server/picture/png_rows.hpp"
#include "store/slice.hpp"

namespace teracell {

// The mean of colours, each with the same weight: channels are multiplied by alpha / 255 (rounded half up to 8 bits),
// channels and alpha averaged (half up), and the channels divided by the mean alpha again (half up) for the PNG.
Rgba blend(std::span<const Rgba> colors);

// The colour of a cell by the materials of its set: those that are shown, blended; transparent when none is.
class MaterialColors {
 public:
  explicit MaterialColors(const Metadata& meta, std::vector<bool> shown = {});  // by material; empty: all
  Rgba of(std::span<const uint32_t> materials) const;

 private:
  std::vector<Rgba> colors_;
  std::vector<bool> shown_;
};

// Colours by number, handed out as sets turn up; number 0 is material 0's. With at most 256 colours possible they are
// all known beforehand, so that a picture can have a palette. Threads may share it.
class SetColors {
 public:
  // The pictures of `level`: on level 0 sets have one member. Keeps a reference to `meta`.
  SetColors(const Metadata& meta, int level, std::vector<bool> shown = {});
  uint16_t number(const std::vector<Label>& set) { return number_of_materials(materials_of(meta_, set)); }
  SetValue value() {
    return [this](const std::vector<Label>& set) { return number(set); };
  }
  bool complete() const { return complete_; }  // colors() will not grow
  std::vector<Rgba> colors() const;

 private:
  uint16_t number_of_materials(const std::vector<uint32_t>& materials);
  const Metadata& meta_;
  const MaterialColors of_materials_;
  bool complete_ = false;
  mutable std::mutex mutex_;
  std::vector<Rgba> colors_;
  std::unordered_map<uint32_t, uint16_t> by_color_;
};

// Writes a PNG of any size with the memory of a few rows, and of none where these are longer than kLongest: pictures of
// 10^5 x 10^5 and of 10^9 x 1 cells must stream.
class PngWriter {
 public:
  using Sink = PngFile::Sink;
  static constexpr uint32_t kLongest = 1 << 22;  // pixels of a row that is compared with the one above
  // `colors` gives the colour of a number when a row is written; when it is complete it is the palette.
  PngWriter(uint32_t width, uint32_t height, const SetColors& colors, Sink sink);
  // The next row from the top, or the next part of one.
  void append(std::span<const uint16_t> numbers);
  void finish();  // REQUIRES: height rows were written

 private:
  void know(std::span<const uint16_t> numbers);
  void row(std::span<const uint16_t> numbers);
  const SetColors& colors_;
  const uint32_t width_;
  std::optional<PngRows> rows_;
  std::optional<PngLongRows> long_rows_;  // or these
  std::vector<uint32_t> value_;           // of a number, for both
  std::vector<uint16_t> part_;            // of a row that came in parts
  std::vector<uint16_t> numbers_;  // of the row before
  std::vector<uint32_t> changed_;
};

}  // namespace teracell
