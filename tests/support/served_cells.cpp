#include "tests/support/served_cells.hpp"

#include <zlib.h>

#include "server/api/routes.hpp"
#include "server/picture/picture.hpp"

namespace teracell::testing {

ServedCells::ServedCells(const Grid& grid, int ray_axis, uint32_t labels, uint32_t shift, const std::string& id) : path_(folder_ / (id + ".tcell")) {
  meta_ = metadata_of(grid, ray_axis, labels + shift);
  meta_.units = "mm";
  meta_.chunk_rays = 16;
  meta_.chunk_cells = 32;
  meta_.page_chunks = 2;
  meta_.labels.resize(labels);
  for (uint32_t label = 1; label < labels; ++label) meta_.labels[label].material = label + shift;
  for (uint32_t m = 0; m < meta_.materials.size(); ++m)
    meta_.materials[m].color = fmt::format("#{:06x}{}", (m * 0x9E3779u) & 0xFFFFFF, m == 0 ? "00" : "ff");
  std::mt19937_64 random(labels + shift + static_cast<uint32_t>(ray_axis));
  cells_ = random_cells(random, grid.cells(), labels);
  store_cells(path_, meta_, cells_);
  service_ = std::make_unique<server::Service>(server::ServiceOptions{.named = {path_}, .max_pixels = 1 << 19});
}

server::Response ServedCells::get(const std::string& target) { return get({.target = target, .origin = "http://host:8080"}); }

server::Response ServedCells::get(const server::Request& request) { return handle(*service_, request); }

nlohmann::ordered_json ServedCells::json(const std::string& target) {
  INFO(target);
  const server::Response r = get(target);
  REQUIRE(r.status == 200);
  REQUIRE(r.content_type.find("json") != std::string::npos);
  return nlohmann::ordered_json::parse(*r.body);
}

std::vector<uint32_t> ServedCells::materials(int level) const {
  std::vector<uint32_t> out;
  for (const Mask mask : level_by_hand(meta_.grid, cells_, level))
    out.push_back(meta_.labels[static_cast<size_t>(63 - std::countl_zero(mask))].material);  // later ones are stronger
  return out;
}

std::vector<Rgba> ServedCells::colors(int level) const {
  std::vector<Rgba> out;
  for (const Mask mask : level_by_hand(meta_.grid, cells_, level)) {
    std::vector<Rgba> of_set;
    for (size_t label = 0; label < meta_.labels.size(); ++label)
      if (mask >> label & 1) of_set.push_back(*parse_color(meta_.materials[meta_.labels[label].material].color));
    out.push_back(server::blend(of_set));
  }
  return out;
}

Grid odd_grid() { return {{Axis::uniform(-3, 0.1, 5, 70, 0.5), Axis::uniform(1, 0.1, 0, 130, 0.5), Axis::uniform(2.5, 0.1, 0, 67, 0.5)}}; }

Grid graded_grid() {
  Grid grid = odd_grid();
  std::vector<double> planes;
  for (int i = 0; i <= 130; ++i) planes.push_back(1 + 0.1 * i + 0.001 * i * i);
  grid.axis[1] = Axis::graded(planes, 0.5);
  return grid;
}

std::string inflated(const std::string& bytes, size_t expected) {
  z_stream z{};
  REQUIRE(inflateInit2(&z, MAX_WBITS + 32) == Z_OK);
  std::string out(expected + 1, '\0');  // one more, to notice what is too long
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
  z.avail_in = static_cast<uInt>(bytes.size());
  z.next_out = reinterpret_cast<Bytef*>(out.data());
  z.avail_out = static_cast<uInt>(out.size());
  const int end = inflate(&z, Z_FINISH);
  const auto size = z.total_out;
  const auto left = z.avail_in;
  inflateEnd(&z);
  REQUIRE(end == Z_STREAM_END);
  REQUIRE(size == expected);
  REQUIRE(left == 0);
  out.resize(expected);
  return out;
}

std::vector<uint32_t> ids_of(const std::string& bytes, size_t width) {
  std::vector<uint32_t> out(bytes.size() / width, 0);
  for (size_t i = 0; i < bytes.size(); ++i) out[i / width] |= static_cast<uint32_t>(static_cast<uint8_t>(bytes[i])) << (8 * (i % width));
  return out;
}

std::vector<uint32_t> joined_blocks(const std::vector<int64_t>& n, const std::vector<int64_t>& c,
                                    const std::function<std::vector<uint32_t>(int64_t kz, int64_t ky, int64_t kx)>& block) {
  std::vector<uint32_t> out(static_cast<size_t>(n[0] * n[1] * n[2]));
  bool padding = false;
  for (int64_t kz = 0; kz * c[0] < n[0]; ++kz)
    for (int64_t ky = 0; ky * c[1] < n[1]; ++ky)
      for (int64_t kx = 0; kx * c[2] < n[2]; ++kx) {
        const auto ids = block(kz, ky, kx);
        for (size_t i = 0; i < ids.size(); ++i) {
          const auto k = static_cast<int64_t>(i);
          const int64_t z = kz * c[0] + k / (c[1] * c[2]), y = ky * c[1] + k / c[2] % c[1], x = kx * c[2] + k % c[2];
          if (z < n[0] && y < n[1] && x < n[2]) out[static_cast<size_t>((z * n[1] + y) * n[2] + x)] = ids[i];
          else padding |= ids[i] != 0;
        }
      }
  REQUIRE_FALSE(padding);
  return out;
}

void require_missing(const server::Response& response) {
  REQUIRE(response.status == 404);
  REQUIRE(response.body);
  REQUIRE(response.body->empty());
}

void require_missing(ServedCells& served, const std::vector<std::string>& paths) {
  for (const std::string& path : paths) {
    INFO(path);
    require_missing(served.get(path));
  }
}

}  // namespace teracell::testing
