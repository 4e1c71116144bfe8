#include "tools/export/arrays/dense.hpp"

#include <algorithm>

#include "store/read/query.hpp"

namespace teracell::exports {
namespace {

constexpr int64_t kSlabBytes = 64 << 20;

}  // namespace

// A slab is as many layers of the slowest axis as fit it. Where not even one fits, it is rows of a layer, or a part of a row.
void for_each_slab(const Export& e, const AxisOrder& order, size_t bytes, const std::function<void(const Box&, const Index3&, size_t)>& take) {
  const auto [slow, middle, fast] = order;
  const auto& [lo, hi] = e.box;
  const int64_t row_cells = hi[fast] - lo[fast], layer_rows = hi[middle] - lo[middle];
  const auto fit = [](int64_t count, int64_t size) { return std::clamp<int64_t>(kSlabBytes / size, 1, count); };
  const int64_t columns = fit(row_cells, static_cast<int64_t>(bytes)), row = row_cells * static_cast<int64_t>(bytes), rows = fit(layer_rows, row);
  const int64_t layers = rows < layer_rows ? 1 : fit(hi[slow] - lo[slow], layer_rows * row);
  const double cells = static_cast<double>(row_cells) * static_cast<double>(layer_rows) * static_cast<double>(hi[slow] - lo[slow]);
  double done = 0;
  for (int64_t k = lo[slow]; k < hi[slow]; k += layers)
    for (int64_t j = lo[middle]; j < hi[middle]; j += rows)
      for (int64_t i = lo[fast]; i < hi[fast]; i += columns) {
        e.progress(done / cells);
        Box part;
        part.lo[slow] = k, part.hi[slow] = std::min(hi[slow], k + layers);
        part.lo[middle] = j, part.hi[middle] = std::min(hi[middle], j + rows);
        part.lo[fast] = i, part.hi[fast] = std::min(hi[fast], i + columns);
        Index3 stride;
        stride[fast] = 1;
        stride[middle] = part.hi[fast] - i;
        stride[slow] = stride[middle] * (part.hi[middle] - j);
        const int64_t count = stride[slow] * (part.hi[slow] - k);
        take(part, stride, static_cast<size_t>(count));
        done += static_cast<double>(count);
      }
  e.progress(1);
}

template <class T>
void for_each_slab(const Export& e, const AxisOrder& order, const std::function<void(std::span<const T>)>& take) {
  const SetValue number = e.number();
  std::vector<T> slab;
  for_each_slab(e, order, sizeof(T), [&](const Box& part, const Index3& stride, size_t cells) {
    slab.resize(cells);
    read_box<T>(e.reader, e.level, part, number, 0, slab.data(), stride);
    take(slab);
  });
}

template void for_each_slab(const Export&, const AxisOrder&, const std::function<void(std::span<const uint8_t>)>&);
template void for_each_slab(const Export&, const AxisOrder&, const std::function<void(std::span<const uint16_t>)>&);
template void for_each_slab(const Export&, const AxisOrder&, const std::function<void(std::span<const uint32_t>)>&);

void append_dense_cells(const Export& e, OutputFile& file) {
  with_number(bytes_per_cell(e.most()), [&]<class T>(T) {  // little endian, like every machine this runs on
    for_each_slab<T>(e, kXFastest, [&](std::span<const T> slab) { file.append({reinterpret_cast<const uint8_t*>(slab.data()), slab.size_bytes()}); });
  });
}

}  // namespace teracell::exports
