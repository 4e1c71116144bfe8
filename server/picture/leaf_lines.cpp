#include "server/picture/leaf_lines.hpp"

#include <algorithm>

namespace teracell::server {
namespace {

constexpr int64_t kPixelsAtOnce = 4 << 20;

}  // namespace

// From fine to coarse: from red over yellow and green to blue, and round again, darker each time.
Rgba LeafLines::color(int level) {
  static constexpr std::array<Rgba, 8> kColors = {{{200, 30, 30, 255},
                                                   {230, 110, 20, 255},
                                                   {205, 165, 0, 255},
                                                   {110, 170, 40, 255},
                                                   {20, 150, 110, 255},
                                                   {20, 130, 200, 255},
                                                   {50, 70, 190, 255},
                                                   {120, 50, 160, 255}}};
  Rgba color = kColors[static_cast<size_t>(level) % kColors.size()];
  for (size_t c = 0; c < 3; ++c) color[c] = static_cast<uint8_t>(color[c] >> (level / std::ssize(kColors)));
  return color;
}

LeafLines::LeafLines(const Leaves& leaves, const SliceView& view, std::vector<int64_t> columns, std::vector<int64_t> rows, int threads,
                     SetColors& colors)
    : leaves_(leaves), view_(view), columns_(std::move(columns)), rows_(std::move(rows)), threads_(threads) {
  for (int level = 0; level <= leaves.coarsest(); ++level) numbers_.push_back(colors.number_of(color(level)));
  first_ = end_ = std::ssize(rows_);
}

// Reads a band of rows down from this one, and the ones beside it.
void LeafLines::read(int64_t row) {
  const int64_t width = std::ssize(columns_), many = std::max<int64_t>(3, kPixelsAtOnce / std::max<int64_t>(1, width));
  end_ = std::min(std::ssize(rows_), row + 2), first_ = std::max<int64_t>(0, end_ - many);
  levels_.assign(static_cast<size_t>((end_ - first_) * width), 0);
  SliceView band = view_;
  band.v0 = rows_[static_cast<size_t>(first_)], band.v1 = rows_[static_cast<size_t>(end_ - 1)] + 1;
  const RayFrame f = RayFrame::along(view_.axis);
  const auto place = [](const std::vector<int64_t>& cells, int64_t cell) { return std::ranges::lower_bound(cells, cell) - cells.begin(); };
  leaves_.for_each(
      cells_below(band), threads_, [](double) {},
      [&](std::span<const Leaf> leaves) {
        for (const Leaf& leaf : leaves) {
          const int64_t size = int64_t{1} << leaf.level, u = leaf.cell[f.u] << leaf.level, v = leaf.cell[f.v] << leaf.level;
          const int64_t u0 = place(columns_, u), u1 = place(columns_, u + size);
          const int64_t v0 = std::max(first_, place(rows_, v)), v1 = std::min(end_, place(rows_, v + size));
          for (int64_t y = v0; y < v1; ++y) std::fill_n(levels_.begin() + (y - first_) * width + u0, u1 - u0, static_cast<uint8_t>(leaf.level));
        }
      });
}

// Whether two pixels show the same leaf: cells of one level have the same place among those of this level.
bool LeafLines::same(int64_t u, int64_t v, int64_t u2, int64_t v2) const {
  if (u2 < 0 || u2 >= std::ssize(columns_) || v2 < 0 || v2 >= std::ssize(rows_)) return false;
  const int l = level(u, v);
  const auto at = [&](const std::vector<int64_t>& cells, int64_t i) { return cells[static_cast<size_t>(i)] >> l; };
  return l == level(u2, v2) && at(columns_, u) == at(columns_, u2) && at(rows_, v) == at(rows_, v2);
}

void LeafLines::draw(int64_t row, std::span<uint16_t> pixels) {
  if (row < first_ + (first_ > 0 ? 1 : 0)) read(row);
  for (int64_t u = 0; u < std::ssize(columns_); ++u) {
    const bool left = !same(u, row, u - 1, row) && same(u, row, u + 1, row), below = !same(u, row, u, row - 1) && same(u, row, u, row + 1);
    if (left || below) pixels[static_cast<size_t>(u)] = numbers_[static_cast<size_t>(level(u, row))];
  }
}

}  // namespace teracell::server
