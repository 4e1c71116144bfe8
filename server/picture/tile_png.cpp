#include "server/picture/tile_png.hpp"

#include <algorithm>
#include <vector>

#include "server/picture/png_rows.hpp"

namespace teracell::server {

std::string encode_png(uint32_t width, uint32_t height, std::span<const uint16_t> numbers, std::span<const Rgba> colors) {
  const auto row = [&](uint32_t r) { return numbers.subspan(size_t{r} * width, width); };
  // Where a number occurs for the first time, the row differs from the one above. So all numbers occur in changed groups.
  std::vector<uint32_t> changes;
  std::vector<size_t> ends;  // of the changes of each row
  std::vector<uint8_t> occurs(colors.size(), 0);
  ends.reserve(height);
  for (uint32_t r = 0; r < height; ++r) {
    const size_t before = changes.size();
    append_changes(r == 0 ? std::span<const uint16_t>() : row(r - 1), row(r), changes);
    for (size_t i = before; i < changes.size(); ++i) {
      const size_t first = size_t{changes[i]} * 8;
      for (const uint16_t n : row(r).subspan(first, std::min<size_t>(8, width - first))) occurs[n] = 1;
    }
    ends.push_back(changes.size());
  }

  // Equal colours share a place in the palette.
  std::vector<Rgba> palette;
  std::vector<uint32_t> value(colors.size(), 0);
  for (size_t n = 0; n < colors.size() && palette.size() <= PngFile::kMostColors; ++n) {
    if (!occurs[n]) continue;
    value[n] = static_cast<uint32_t>(std::ranges::find(palette, colors[n]) - palette.begin());
    if (value[n] == palette.size()) palette.push_back(colors[n]);
  }
  if (palette.size() > PngFile::kMostColors) {
    palette.clear();
    for (size_t n = 0; n < colors.size(); ++n) value[n] = PngFile::rgba(colors[n]);
  }

  std::string png;
  PngRows rows(width, height, palette,
               [&](std::span<const uint8_t> bytes) { png.append(reinterpret_cast<const char*>(bytes.data()), bytes.size()); });
  size_t begin = 0;
  for (uint32_t r = 0; r < height; ++r) {
    rows.row(row(r), std::span(changes).subspan(begin, ends[r] - begin), value.data());
    begin = ends[r];
  }
  rows.finish();
  return png;
}

}  // namespace teracell::server
