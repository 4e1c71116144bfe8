#include "server/blocks.hpp"

#include <zlib.h>

#include <new>

namespace teracell {

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
  std::string out(2 * cells, '\0');
  for (size_t i = 0; i < cells; ++i) {
    out[2 * i] = static_cast<char>(ids[i] & 0xFF);
    out[2 * i + 1] = static_cast<char>(ids[i] >> 8);
  }
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

std::string deflated(std::string_view bytes, Wrapping wrapping) {
  z_stream z{};
  if (deflateInit2(&z, 1, Z_DEFLATED, MAX_WBITS + (wrapping == Wrapping::kGzip ? 16 : 0), 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
  std::string out(deflateBound(&z, bytes.size()), '\0');
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  deflate(&z, Z_FINISH);
  out.resize(z.total_out);
  out.shrink_to_fit();  // it is kept in a cache
  deflateEnd(&z);
  return out;
}

Service::Recipe cube_recipe(const ServedGrid& grid, int level, const Box& cube, Wrapping wrapping) {
  return {.route = "other", .content_type = "application/octet-stream", .make = [&grid, level, cube, wrapping] {
            return deflated(labels_in(grid.reader(), level, cube), wrapping);
          }};
}

}  // namespace teracell
