// Pictures of slices as PNG, streamed row by row, and the colours of sets of materials.
#pragma once
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "server/picture/png_long_rows.hpp"
#include "server/picture/png_rows.hpp"
#include "store/read/slice.hpp"

namespace teracell::server {

// The mean of colours with equal weights. The channels are multiplied by alpha / 255 (rounded half up to 8 bits), channels and
// alpha are averaged (half up), and for the PNG the channels are divided by the mean alpha (half up).
Rgba blend(std::span<const Rgba> colors);

// The colour of a cell: the blend of those materials of its set that are shown; transparent when none is.
class MaterialColors {
 public:
  explicit MaterialColors(const Metadata& meta, std::vector<bool> shown = {});  // by material; empty: all
  Rgba of(std::span<const uint32_t> materials) const;

 private:
  std::vector<Rgba> colors_;
  std::vector<bool> shown_;
};

// Numbers for colours, given to sets as they occur; material 0 has number 0. When no more than 256 colours are possible, all are
// known beforehand, so that a picture can have a palette. Threads may share it.
class SetColors {
 public:
  // For pictures of `level` (on level 0 each set has one member). Keeps a reference to `meta`.
  SetColors(const Metadata& meta, int level, std::vector<bool> shown = {});
  uint16_t number_of(const Rgba& color);  // of one that is drawn besides. REQUIRES: before there is a PngWriter
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

// Writes a PNG of any size. It holds a few rows in memory, and none when a row is longer than kLongest: pictures of 10^5 x 10^5 and
// of 10^9 x 1 cells must stream.
class PngWriter {
 public:
  using Sink = PngFile::Sink;
  static constexpr uint32_t kLongest = 1 << 22;  // pixels of a row that is compared with the one above
  // `colors` is asked for the colours of new numbers when a row is written. When it is complete, it is the palette.
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
  std::optional<PngLongRows> long_rows_;  // one of the two is set
  std::vector<uint32_t> value_;           // of each number, for PngFile::pack()
  std::vector<uint16_t> part_;            // the beginning of a row that comes in parts
  std::vector<uint16_t> numbers_;         // the previous row
  std::vector<uint32_t> changed_;
};

}  // namespace teracell::server
