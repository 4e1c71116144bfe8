#include "tests/support/foreign.hpp"

#include <zlib.h>

#include <bit>

#include <catch2/catch.hpp>
#include <fmt/format.h>

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
  for (uint32_t m = 0; m < meta_.materials.size(); ++m) meta_.materials[m].color = fmt::format("#{:06x}{}", (m * 0x9E3779u) & 0xFFFFFF, m == 0 ? "00" : "ff");
  std::mt19937_64 random(labels + shift + static_cast<uint32_t>(ray_axis));
  cells_ = random_cells(random, grid.cells(), labels);
  store_cells(path_, meta_, cells_);
  service_ = std::make_unique<Service>(ServiceOptions{.named = {path_}, .max_pixels = 1 << 19});
}

Response ServedCells::get(const std::string& target) {
  Request request;
  request.target = target;
  request.origin = "http://host:8080";
  return get(request);
}

Response ServedCells::get(const Request& request) { return handle(*service_, request); }

nlohmann::ordered_json ServedCells::json(const std::string& target) {
  INFO(target);
  const Response r = get(target);
  REQUIRE(r.status == 200);
  REQUIRE(r.content_type.find("json") != std::string::npos);
  return nlohmann::ordered_json::parse(*r.body);
}

std::vector<uint32_t> ServedCells::materials(int level) const {
  std::vector<uint32_t> out;
  for (const Mask mask : level_by_hand(meta_.grid, cells_, level)) out.push_back(meta_.labels[static_cast<size_t>(63 - std::countl_zero(mask))].material);  // later ones are stronger
  return out;
}

std::vector<Rgba> ServedCells::colors(int level) const {
  std::vector<Rgba> out;
  for (const Mask mask : level_by_hand(meta_.grid, cells_, level)) {
    std::vector<Rgba> of_set;
    for (size_t label = 0; label < meta_.labels.size(); ++label)
      if (mask >> label & 1) of_set.push_back(*parse_color(meta_.materials[meta_.labels[label].material].color));
    out.push_back(blend(of_set));
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

// A palette of 1 to 8 bits, or RGBA; any filter; not interlaced.
Png png_of(const std::string& bytes) {
  const auto byte = [&](size_t at) { return static_cast<uint8_t>(bytes.at(at)); };
  const auto be32 = [&](size_t at) { return uint32_t{byte(at)} << 24 | uint32_t{byte(at + 1)} << 16 | uint32_t{byte(at + 2)} << 8 | byte(at + 3); };
  REQUIRE(bytes.substr(0, 8) == "\x89PNG\r\n\x1a\n");
  Png out;
  size_t bits = 0;
  bool palette = false;
  std::vector<Rgba> colors;
  std::string data;
  for (size_t at = 8; at < bytes.size();) {
    const size_t size = be32(at);
    const std::string type = bytes.substr(at + 4, 4);
    if (type == "IHDR") {
      out.width = be32(at + 8), out.height = be32(at + 12);
      palette = byte(at + 17) == 3;
      REQUIRE((palette || (byte(at + 17) == 6 && byte(at + 16) == 8)));
      bits = palette ? byte(at + 16) : 32;
    }
    if (type == "PLTE")
      for (size_t i = 0; i < size; i += 3) colors.push_back({byte(at + 8 + i), byte(at + 9 + i), byte(at + 10 + i), 255});
    if (type == "tRNS")
      for (size_t i = 0; i < size; ++i) colors.at(i)[3] = byte(at + 8 + i);
    if (type == "IDAT") data += bytes.substr(at + 8, size);
    at += size + 12;
  }
  const size_t line = (static_cast<size_t>(out.width) * bits + 7) / 8, step = std::max<size_t>(bits / 8, 1);
  const std::string raw = inflated(data, (line + 1) * static_cast<size_t>(out.height));
  std::vector<uint8_t> row(line, 0);
  for (size_t r = 0; r < static_cast<size_t>(out.height); ++r) {
    const std::vector<uint8_t> above = row;
    const char filter = raw[r * (line + 1)];
    for (size_t i = 0; i < line; ++i) {
      const int a = i < step ? 0 : row[i - step], b = above[i], c = i < step ? 0 : above[i - step];
      const int pa = std::abs(b - c), pb = std::abs(a - c), pc = std::abs(a + b - 2 * c);
      const int paeth = pa <= pb && pa <= pc ? a : pb <= pc ? b : c;
      const int guess[] = {0, a, b, (a + b) / 2, paeth};
      REQUIRE((filter >= 0 && filter <= 4));
      row[i] = static_cast<uint8_t>(raw[r * (line + 1) + 1 + i] + guess[static_cast<size_t>(filter)]);
    }
    for (size_t x = 0; x < static_cast<size_t>(out.width); ++x) {
      if (palette) out.pixels.push_back(colors.at(row[x * bits / 8] >> (8 - bits - x * bits % 8) & ((1 << bits) - 1)));
      else out.pixels.push_back({row[4 * x], row[4 * x + 1], row[4 * x + 2], row[4 * x + 3]});
    }
  }
  return out;
}

void require_missing(const Response& response) {
  REQUIRE(response.status == 404);
  REQUIRE(response.body);
  REQUIRE(response.body->empty());
}

}  // namespace teracell::testing
