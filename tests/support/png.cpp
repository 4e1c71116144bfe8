#include "tests/support/png.hpp"

#include <zlib.h>

namespace teracell::testing {
namespace {

struct PngChunk {
  std::string type;
  std::vector<uint8_t> data;
};

uint32_t be32(const uint8_t* p) { return uint32_t{p[0]} << 24 | uint32_t{p[1]} << 16 | uint32_t{p[2]} << 8 | p[3]; }

std::vector<PngChunk> chunks_of(std::span<const uint8_t> png) {
  constexpr uint8_t kSignature[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
  REQUIRE(png.size() > 8);
  REQUIRE(std::equal(kSignature, kSignature + 8, png.begin()));
  std::vector<PngChunk> chunks;
  for (size_t at = 8; at < png.size();) {
    REQUIRE(png.size() - at >= 12);
    const uint32_t size = be32(&png[at]);
    REQUIRE(png.size() - at - 12 >= size);
    REQUIRE(be32(&png[at + 8 + size]) == crc32(0, &png[at + 4], size + 4));
    chunks.push_back({std::string(png.begin() + at + 4, png.begin() + at + 8), {png.begin() + at + 8, png.begin() + at + 8 + size}});
    at += 12 + size;
  }
  REQUIRE(chunks.front().type == "IHDR");
  REQUIRE(chunks.back().type == "IEND");
  REQUIRE(chunks.back().data.empty());
  return chunks;
}

std::vector<uint8_t> inflated(const std::vector<uint8_t>& data, size_t expected) {
  std::vector<uint8_t> out(expected + 1);  // one more, to notice what is too long
  uLongf size = out.size();
  REQUIRE(uncompress(out.data(), &size, data.data(), data.size()) == Z_OK);
  REQUIRE(size == expected);
  out.resize(size);
  return out;
}

}  // namespace

Decoded decode(std::span<const uint8_t> png) {
  Decoded d;
  std::vector<uint8_t> data, alpha;
  for (const PngChunk& c : chunks_of(png)) {
    if (c.type == "IHDR") {
      REQUIRE(c.data.size() == 13);
      d.width = be32(&c.data[0]), d.height = be32(&c.data[4]), d.bits = c.data[8], d.kind = c.data[9];
      REQUIRE((c.data[10] == 0 && c.data[11] == 0 && c.data[12] == 0));
    } else if (c.type == "PLTE") {
      for (size_t i = 0; i + 2 < c.data.size(); i += 3) d.palette.push_back({c.data[i], c.data[i + 1], c.data[i + 2], 255});
    } else if (c.type == "tRNS") {
      d.alphas = c.data.size();
      REQUIRE(d.alphas <= d.palette.size());
      for (size_t i = 0; i < d.alphas; ++i) d.palette[i][3] = c.data[i];
    } else if (c.type == "IDAT") {
      data.insert(data.end(), c.data.begin(), c.data.end());
      ++d.data_chunks;
    }
  }
  const bool palette = d.kind == 3;
  REQUIRE((palette || (d.kind == 6 && d.bits == 8)));
  const size_t line = (size_t{d.width} * static_cast<size_t>(palette ? d.bits : 32) + 7) / 8;
  const auto raw = inflated(data, d.height * (line + 1));
  std::vector<uint8_t> above(line, 0);
  for (uint32_t r = 0; r < d.height; ++r) {
    const uint8_t* p = &raw[r * (line + 1)];
    REQUIRE(p[0] <= 4);
    const size_t pixel = palette ? 1 : 4;
    std::vector<uint8_t> here(line);
    for (size_t i = 0; i < line; ++i) {
      const int left = i < pixel ? 0 : here[i - pixel], up = above[i], corner = i < pixel ? 0 : above[i - pixel];
      const int to_left = std::abs(up - corner), to_up = std::abs(left - corner), to_corner = std::abs(left + up - 2 * corner);
      const int paeth = to_left <= to_up && to_left <= to_corner ? left : to_up <= to_corner ? up : corner;
      const int predicted[] = {0, left, up, (left + up) / 2, paeth};
      here[i] = static_cast<uint8_t>(p[i + 1] + predicted[p[0]]);
    }
    above = here;
    auto& row = d.rows.emplace_back();
    for (uint32_t i = 0; i < d.width; ++i) {
      if (!palette) {
        row.push_back({above[4 * i], above[4 * i + 1], above[4 * i + 2], above[4 * i + 3]});
        continue;
      }
      const uint32_t per_byte = 8 / static_cast<uint32_t>(d.bits), shift = static_cast<uint32_t>(d.bits) * (per_byte - 1 - i % per_byte);
      const uint32_t number = above[i / per_byte] >> shift & ((1u << d.bits) - 1);
      if (number >= d.palette.size()) FAIL("a pixel has no colour");
      row.push_back(d.palette[number]);
    }
  }
  return d;
}

Png png_of(const std::string& bytes) {
  const Decoded d = decode({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  Png out{d.width, d.height, {}};
  for (const auto& row : d.rows) out.pixels.insert(out.pixels.end(), row.begin(), row.end());
  return out;
}

}  // namespace teracell::testing
