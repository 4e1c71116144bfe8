#include "server/parts/box_parts.hpp"

#include <algorithm>

#include "store/grid/vtk_header.hpp"
#include "store/read/query.hpp"
#include "store/text/npy_header.hpp"

namespace teracell::server {
namespace {

constexpr int64_t kSlab = int64_t{1} << 20;  // cells that are read at once

class BoxParts final : public Parts {
 public:
  BoxParts(const GridReader& reader, const Box& box, BoxFormat format)
      : reader_(reader), box_(box), format_(format), wide_(wide_labels(reader.meta())), next_(box.lo) {}

  bool append(std::string& out) override {
    const size_t enough = out.size() + kEnough;
    if (!begun_) out += header();
    begun_ = true;
    while (out.size() < enough && next_[2] < box_.hi[2]) append_slab(out);
    if (next_[2] < box_.hi[2]) return true;
    if (format_ != BoxFormat::kNpy) out += kVtkFooter;
    return false;
  }
  size_t memory() const override { return sizeof *this; }

 private:
  std::string header() const {
    const Index3 n = {box_.hi[0] - box_.lo[0], box_.hi[1] - box_.lo[1], box_.hi[2] - box_.lo[2]};
    if (format_ == BoxFormat::kNpy) {
      const Bytes bytes = npy_header(wide_ ? "<u2" : "|u1", {n[2], n[1], n[0]});
      return {bytes.begin(), bytes.end()};
    }
    const Metadata& meta = reader_.meta();
    VtkGrid grid{n, {}, {}, {}, meta.materials};
    for (int d = 0; d < 3; ++d) {
      const Axis& axis = meta.grid.axis[d];
      if (format_ == BoxFormat::kVti) grid.origin[d] = axis.plane(box_.lo[d]), grid.step[d] = axis.step();
      else
        for (int64_t i = box_.lo[d]; i <= box_.hi[d]; ++i) grid.planes[d].push_back(axis.plane(i));
    }
    return vtk_header(grid, wide_ ? 2 : 1);
  }

  // Whole layers, whole rows of a layer, or a part of a row.
  void append_slab(std::string& out) {
    const auto& [lo, hi] = box_;
    const int64_t row = hi[0] - lo[0], layer = row * (hi[1] - lo[1]);
    Box slab{next_, {next_[0] + 1, next_[1] + 1, next_[2] + 1}};
    slab.hi[0] = std::min(hi[0], next_[0] + kSlab);
    if (row <= kSlab) slab.hi[1] = std::min(hi[1], next_[1] + kSlab / row);
    if (layer <= kSlab) slab.hi[2] = std::min(hi[2], next_[2] + kSlab / layer);
    next_[0] = slab.hi[0];
    if (next_[0] == hi[0]) next_[0] = lo[0], next_[1] = slab.hi[1];
    if (next_[1] == hi[1]) next_[1] = lo[1], next_[2] = slab.hi[2];
    append_cells(slab, out);
  }

  void append_cells(const Box& slab, std::string& out) {
    const int64_t nx = slab.hi[0] - slab.lo[0], ny = slab.hi[1] - slab.lo[1], nz = slab.hi[2] - slab.lo[2];
    std::vector<uint16_t> cells(static_cast<size_t>(nx * ny * nz));
    read_box<uint16_t>(reader_, 0, slab, strongest_material(reader_.meta()), 0, cells.data(), {1, nx, nx * ny});
    if (wide_) out.append(reinterpret_cast<const char*>(cells.data()), cells.size() * sizeof(uint16_t));
    else out.append(cells.begin(), cells.end());
  }

  const GridReader& reader_;
  const Box box_;
  const BoxFormat format_;
  const bool wide_;
  Index3 next_;  // cell
  bool begun_ = false;
};

}  // namespace

std::unique_ptr<Parts> box_parts(const GridReader& reader, const Box& box, BoxFormat format) {
  return std::make_unique<BoxParts>(reader, box, format);
}

}  // namespace teracell::server
