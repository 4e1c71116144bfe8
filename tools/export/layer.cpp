#include "tools/export/layer.hpp"

#include <algorithm>

#include "store/read/query.hpp"

namespace teracell::exports {
namespace {

constexpr int64_t kCellsAtOnce = 16 << 20;

int64_t that_fit(int64_t count, int64_t cells_each) { return std::clamp<int64_t>(kCellsAtOnce / cells_each, 1, count); }

}  // namespace

Export for_layers(const Export& e) {
  Export out = e;
  out.progress = [told = e.progress, most = 0.0](double share) mutable { told(most = std::max(most, share)); };
  return out;
}

LayerReader::LayerReader(const Export& e, const std::vector<bool>& in_mesh)
    : e_(e), in_mesh_(in_mesh), size_(size_of(e.box)), material_(strongest_material(e.reader.meta())) {
  columns_ = that_fit(size_[0], 1);
  rows_ = columns_ < size_[0] ? 1 : that_fit(size_[1], size_[0]);
  layers_ = rows_ < size_[1] ? 1 : that_fit(size_[2], size_[0] * size_[1]);
}

void LayerReader::read_part(const Box& part) {
  e_.progress(0);
  Box box = part;
  for (int d = 0; d < 3; ++d) box.lo[d] += e_.box.lo[d], box.hi[d] += e_.box.lo[d];
  const Index3 n = size_of(box);
  slab_.resize(static_cast<size_t>(n[0] * n[1] * n[2]));
  read_box<uint16_t>(e_.reader, e_.level, box, material_, 0, slab_.data(), {1, n[0], n[0] * n[1]});
}

void LayerReader::read(int64_t z, Layer& out) {
  out.clear();
  if (rows_ == size_[1]) {
    if (z >= to_) {
      from_ = z, to_ = std::min(size_[2], z + layers_);
      read_part({{0, 0, from_}, {size_[0], size_[1], to_}});
    }
    for (int64_t y = 0; y < size_[1]; ++y) {
      append_row(slab_.data() + ((z - from_) * size_[1] + y) * size_[0], 0, size_[0], out);
      out.rows.push_back(out.runs.size());
    }
    return;
  }
  for (int64_t y = 0; y < size_[1]; y += rows_)
    for (int64_t x = 0; x < size_[0]; x += columns_) {
      const Box part{{x, y, z}, {std::min(size_[0], x + columns_), std::min(size_[1], y + rows_), z + 1}};
      read_part(part);
      const int64_t width = part.hi[0] - x;
      for (int64_t row = y; row < part.hi[1]; ++row) {
        append_row(slab_.data() + (row - y) * width, x, width, out);
        if (part.hi[0] == size_[0]) out.rows.push_back(out.runs.size());
      }
    }
}

void LayerReader::append_row(const uint16_t* cells, int64_t x, int64_t count, Layer& out) const {
  for (int64_t i = 0; i < count;) {
    const uint16_t material = cells[i];
    const int64_t begin = i;
    while (i < count && cells[i] == material) ++i;
    const auto end = static_cast<int32_t>(x + i);
    if (out.runs.size() > out.rows.back() && out.runs.back().what == material) out.runs.back().end = end;
    else out.runs.push_back({static_cast<int32_t>(x + begin), end, material, 0, in_mesh_[material] ? 0 : -1});
  }
}

}  // namespace teracell::exports
