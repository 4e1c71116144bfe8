#include "server/scaled_slice.hpp"

#include <algorithm>
#include <numeric>

#include "server/tiles.hpp"

namespace teracell {

int64_t ScaledSlice::width(int scale) const { return ceil_shift(reader->meta().grid.cells()[Frame::along(axis).u], scale); }
int64_t ScaledSlice::height(int scale) const { return ceil_shift(reader->meta().grid.cells()[Frame::along(axis).v], scale); }

int ScaledSlice::scale_within(int64_t pixels) const {
  int scale = 0;
  while (std::max(width(scale), height(scale)) > pixels) ++scale;
  return scale;
}

std::string ScaledSlice::png(int scale, int64_t x0, int64_t y0, int64_t x1, int64_t y1) const {
  std::vector<int64_t> u(static_cast<size_t>(x1 - x0)), v(static_cast<size_t>(y1 - y0));
  std::iota(u.begin(), u.end(), x0);
  for (size_t i = 0; i < v.size(); ++i) v[i] = (height() - 1 - ((y0 + static_cast<int64_t>(i)) << scale)) >> scale;
  return sampled_png(*reader, axis, index >> scale, scale, u, v);
}

std::optional<ScaledSlice> slice_at(const GridReader& reader, std::string_view axis, std::string_view index) {
  for (int a = 0; a < 3; ++a) {
    const auto i = plain_integer(index);
    if (axis == axis_name(a) && i && *i < reader.meta().grid.cells()[a]) return ScaledSlice{&reader, a, *i};
  }
  return std::nullopt;
}

}  // namespace teracell
