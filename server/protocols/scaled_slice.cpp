#include "server/protocols/scaled_slice.hpp"

#include <algorithm>

namespace teracell::server {

int64_t ScaledSlice::width(int scale) const { return ceil_shift(reader->meta().grid.cells()[RayFrame::along(axis).u], scale); }
int64_t ScaledSlice::height(int scale) const { return ceil_shift(reader->meta().grid.cells()[RayFrame::along(axis).v], scale); }

int ScaledSlice::scale_within(int64_t pixels) const {
  int scale = 0;
  while (std::max(width(scale), height(scale)) > pixels) ++scale;
  return scale;
}

Service::Recipe ScaledSlice::picture(int scale, int64_t x0, int64_t y0, int64_t x1, int64_t y1) const {
  return picture_recipe(*reader, {axis, index >> scale, scale, x0, height(scale) - y1, x1, height(scale) - y0});
}

std::optional<ScaledSlice> slice_at(const GridReader& reader, std::string_view axis, std::string_view index) {
  const auto a = axis_named(axis);
  const auto i = plain_integer(index);
  return a && i && *i < reader.meta().grid.cells()[*a] ? std::optional(ScaledSlice{&reader, *a, *i}) : std::nullopt;
}

}  // namespace teracell::server
