#include "tools/export/dense.hpp"

#include <algorithm>

#include "store/query.hpp"

namespace teracell {
namespace {

constexpr int64_t kSlabBytes = 64 << 20;

// A slab is as many layers of z as fit it. Where not even one fits, it is rows of a layer, or a part of a row.
template <class T>
void append_cells(const Export& e, OutputFile& file) {
  const auto& [lo, hi] = e.box;
  const int64_t nx = hi[0] - lo[0], ny = hi[1] - lo[1], nz = hi[2] - lo[2];
  const auto fit = [](int64_t count, int64_t size) { return std::clamp<int64_t>(kSlabBytes / size, 1, count); };
  const int64_t columns = fit(nx, sizeof(T)), row = nx * static_cast<int64_t>(sizeof(T)), rows = fit(ny, row);
  const int64_t layers = rows < ny ? 1 : fit(nz, ny * row);
  const SetValue number = e.number();
  const double cells = static_cast<double>(nx) * static_cast<double>(ny) * static_cast<double>(nz);
  double done = 0;
  std::vector<T> slab;
  for (int64_t z = lo[2]; z < hi[2]; z += layers)
    for (int64_t y = lo[1]; y < hi[1]; y += rows)
      for (int64_t x = lo[0]; x < hi[0]; x += columns) {
        e.progress(done / cells);
        const Box part{{x, y, z}, {std::min(hi[0], x + columns), std::min(hi[1], y + rows), std::min(hi[2], z + layers)}};
        const int64_t width = part.hi[0] - x, height = part.hi[1] - y;
        slab.resize(static_cast<size_t>(width * height * (part.hi[2] - z)));
        read_box<T>(e.reader, e.level, part, number, 0, slab.data(), {1, width, width * height});
        file.append({reinterpret_cast<const uint8_t*>(slab.data()), slab.size() * sizeof(T)});  // little endian, like every machine this runs on
        done += static_cast<double>(slab.size());
      }
  e.progress(1);
}

}  // namespace

void append_dense_cells(const Export& e, OutputFile& file) {
  const size_t bytes = bytes_per_cell(e.most());
  if (bytes == 1) append_cells<uint8_t>(e, file);
  else if (bytes == 2) append_cells<uint16_t>(e, file);
  else append_cells<uint32_t>(e, file);
}

}  // namespace teracell
