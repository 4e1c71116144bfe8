// The leaves of a refined grid in a picture of a slice: lines between them, in a colour for each level.
#pragma once
#include "server/picture/picture.hpp"
#include "store/refine/leaf_levels.hpp"

namespace teracell::server {

class LeafLines {
 public:
  // `columns` and `rows` are the cells that the picture's pixels show, ascending. The leaves must be prepared for cells_below(view). Keeps references
  // to leaves and colours. REQUIRES: the view is of level 0.
  LeafLines(const Leaves& leaves, const SliceView& view, std::vector<int64_t> columns, std::vector<int64_t> rows, int threads, SetColors& colors);

  // Draws on a row of pixels: those at the lower sides of leaves that are at least two pixels wide, or high. Rows come in descending order.
  void draw(int64_t row, std::span<uint16_t> pixels);
  static Rgba color(int level);

 private:
  void read(int64_t row);
  bool same(int64_t u, int64_t v, int64_t u2, int64_t v2) const;
  int level(int64_t u, int64_t v) const { return levels_[static_cast<size_t>((v - first_) * std::ssize(columns_) + u)]; }

  const Leaves& leaves_;
  const SliceView view_;
  const std::vector<int64_t> columns_, rows_;
  const int threads_;
  std::vector<uint16_t> numbers_;  // of the colours, by level
  int64_t first_ = 0, end_ = 0;  // the rows in levels_
  std::vector<uint8_t> levels_;  // of the leaf that each pixel shows
};

}  // namespace teracell::server
