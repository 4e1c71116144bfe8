#include "server/picture/picture.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace teracell::server {
namespace {

constexpr size_t kMaxSetColors = 65536;

}  // namespace

Rgba blend(std::span<const Rgba> colors) {
  if (colors.size() == 1) return colors[0];
  std::array<uint32_t, 4> sum{};
  for (const Rgba& c : colors) {
    for (int i = 0; i < 3; ++i) sum[i] += (2 * c[i] * c[3] + 255) / 510;  // c * alpha / 255, half up
    sum[3] += c[3];
  }
  const auto n = static_cast<uint32_t>(colors.size());
  std::array<uint32_t, 4> mean;
  for (int i = 0; i < 4; ++i) mean[i] = (2 * sum[i] + n) / (2 * n);
  if (mean[3] == 0) return {0, 0, 0, 0};
  Rgba out;
  for (int i = 0; i < 3; ++i) out[i] = static_cast<uint8_t>(std::min(255u, (2 * mean[i] * 255 + mean[3]) / (2 * mean[3])));
  out[3] = static_cast<uint8_t>(mean[3]);
  return out;
}

MaterialColors::MaterialColors(const Metadata& meta, std::vector<bool> shown) : shown_(std::move(shown)) {
  for (const MaterialInfo& m : meta.materials) colors_.push_back(parse_color(m.color).value());
}

Rgba MaterialColors::of(std::span<const uint32_t> materials) const {
  std::vector<Rgba> members;
  for (const uint32_t m : materials)
    if (shown_.empty() || shown_[m]) members.push_back(colors_[m]);
  return members.empty() ? Rgba{0, 0, 0, 0} : blend(members);
}

SetColors::SetColors(const Metadata& meta, int level, std::vector<bool> shown) : meta_(meta), of_materials_(meta, std::move(shown)) {
  const auto n = static_cast<uint32_t>(meta.materials.size());
  for (uint32_t m = 0; m < n; ++m) number_of_materials({m});
  // Every set of 8 materials or fewer: 255 of them.
  if (level > 0 && n <= 8)
    for (uint32_t members = 1; members < 1u << n; ++members) {
      std::vector<uint32_t> set;
      for (uint32_t m = 0; m < n; ++m)
        if (members >> m & 1) set.push_back(m);
      number_of_materials(set);
    }
  complete_ = (level == 0 || n <= 8) && colors_.size() <= 256;
}

uint16_t SetColors::number_of_materials(const std::vector<uint32_t>& materials) { return number_of(of_materials_.of(materials)); }

uint16_t SetColors::number_of(const Rgba& color) {
  std::lock_guard lock(mutex_);
  if (const auto it = by_color_.find(PngFile::rgba(color)); it != by_color_.end()) return it->second;
  if (colors_.size() == kMaxSetColors)
    throw UsageError(fmt::format("the picture has more than {} colours: ask for a smaller part of it", kMaxSetColors));
  colors_.push_back(color);
  complete_ = complete_ && colors_.size() <= 256;
  const auto number = static_cast<uint16_t>(colors_.size() - 1);
  by_color_[PngFile::rgba(color)] = number;
  return number;
}

std::vector<Rgba> SetColors::colors() const {
  std::lock_guard lock(mutex_);
  return colors_;
}

PngWriter::PngWriter(uint32_t width, uint32_t height, const SetColors& colors, Sink sink) : colors_(colors), width_(width) {
  const std::vector<Rgba> palette = colors.complete() ? colors.colors() : std::vector<Rgba>();
  for (uint32_t n = 0; n < palette.size(); ++n) value_.push_back(n);
  if (width > kLongest) long_rows_.emplace(width, height, palette, std::move(sink));
  else rows_.emplace(width, height, palette, std::move(sink));
}

void PngWriter::append(std::span<const uint16_t> numbers) {
  if (long_rows_) {
    know(numbers);
    return long_rows_->append(numbers, value_.data());
  }
  if (numbers.size() == width_) return row(numbers);
  part_.insert(part_.end(), numbers.begin(), numbers.end());
  if (part_.size() < width_) return;
  row(part_);
  part_.clear();
}

// New sets get their numbers while rows are made, so colours are fetched when a number is new here.
void PngWriter::know(std::span<const uint16_t> numbers) {
  if (*std::ranges::max_element(numbers) < value_.size()) return;
  value_.clear();
  for (const Rgba& c : colors_.colors()) value_.push_back(PngFile::rgba(c));
}

void PngWriter::row(std::span<const uint16_t> numbers) {
  changed_.clear();
  append_changes(numbers_, numbers, changed_);
  if (changed_.empty()) return rows_->repeat();
  numbers_.resize(numbers.size());
  for (const size_t group : changed_) {
    const auto eight = numbers.subspan(8 * group, std::min(numbers.size() - 8 * group, size_t{8}));
    know(eight);
    std::ranges::copy(eight, numbers_.begin() + static_cast<ptrdiff_t>(8 * group));
  }
  rows_->row(numbers, changed_, value_.data());
}

void PngWriter::finish() {
  if (long_rows_) long_rows_->finish();
  else rows_->finish();
}

}  // namespace teracell::server
