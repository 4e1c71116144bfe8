#include "server/protocols/blocks.hpp"

namespace teracell::server {

std::string labels_in(const GridReader& reader, int level, const Box& box) {
  const int64_t nx = box.hi[0] - box.lo[0], ny = box.hi[1] - box.lo[1], nz = box.hi[2] - box.lo[2];
  const Index3 stride = {1, nx, nx * ny};
  const SetValue material = strongest_material(reader.meta());
  const auto cells = static_cast<size_t>(nx * ny * nz);
  if (!wide_labels(reader.meta())) {
    std::string out(cells, '\0');
    read_box<uint8_t>(reader, level, box, material, 0, reinterpret_cast<uint8_t*>(out.data()), stride);
    return out;
  }
  std::vector<uint16_t> ids(cells);
  read_box<uint16_t>(reader, level, box, material, 0, ids.data(), stride);
  std::string out;
  out.reserve(2 * cells);
  put_labels(out, ids, true);
  return out;
}

std::optional<Box> zarr_cube(const Metadata& meta, int level, std::span<const std::string> key) {
  if (key.size() != 3) return std::nullopt;
  const Index3 n = meta.grid.cells(level);
  Box box;
  for (int d = 0; d < 3; ++d) {
    const auto k = plain_integer(key[static_cast<size_t>(2 - d)]);
    if (!k || *k > (n[d] - 1) / kZarrCells) return std::nullopt;
    box.lo[d] = *k * kZarrCells;
    box.hi[d] = box.lo[d] + kZarrCells;
  }
  return box;
}

Service::Recipe cube_recipe(const ServedGrid& grid, int level, const Box& cube, Wrapping wrapping) {
  return {.content_type = "application/octet-stream",
          .make = [&grid, level, cube, wrapping] { return deflated(labels_in(grid.reader(), level, cube), wrapping); }};
}

}  // namespace teracell::server
