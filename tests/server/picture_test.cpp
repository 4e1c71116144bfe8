// Pictures: the colours of sets, and PNGs decoded back by a decoder that shares nothing with the writer but zlib.
#include "server/picture.hpp"

#include <algorithm>
#include <random>
#include <string>
#include <thread>

#include <catch2/catch.hpp>
#include <fmt/format.h>
#include <zlib.h>

#include "store/bytes.hpp"

namespace teracell {
namespace {

struct Png {
  uint32_t width = 0, height = 0;
  int bits = 0, kind = 0;
  std::vector<std::string> chunks;  // their names
  std::vector<size_t> sizes;
  std::vector<Rgba> palette;
  std::vector<std::vector<Rgba>> rows;  // the top first
};

uint32_t be32(std::span<const uint8_t> b) { return uint32_t{b[0]} << 24 | uint32_t{b[1]} << 16 | uint32_t{b[2]} << 8 | b[3]; }

Bytes inflate_all(const Bytes& packed, size_t size) {
  Bytes out(size + 1);  // one more: what is too long shows
  uLongf found = out.size();
  REQUIRE(uncompress(out.data(), &found, packed.data(), packed.size()) == Z_OK);
  REQUIRE(found == size);
  out.resize(size);
  return out;
}

// Understands what the writer may make: filters none and up, kinds 3 (palette) and 6 (RGBA).
Png decode(const Bytes& file) {
  REQUIRE(Bytes(file.begin(), file.begin() + 8) == Bytes{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'});
  Png png;
  Bytes packed;
  for (size_t at = 8; at < file.size();) {
    REQUIRE(file.size() - at >= 12);
    const std::span<const uint8_t> rest = std::span(file).subspan(at);
    const uint32_t size = be32(rest);
    REQUIRE(rest.size() - 12 >= size);
    const auto data = rest.subspan(8, size);
    REQUIRE(be32(rest.subspan(8 + size)) == crc32(0, rest.data() + 4, 4 + size));
    const std::string name(rest.begin() + 4, rest.begin() + 8);
    png.chunks.push_back(name);
    png.sizes.push_back(size);
    if (name == "IHDR") {
      png.width = be32(data), png.height = be32(data.subspan(4));
      png.bits = data[8], png.kind = data[9];
      REQUIRE((data[10] == 0 && data[11] == 0 && data[12] == 0));  // deflate, the five filters, not interlaced
    } else if (name == "PLTE") {
      for (uint32_t i = 0; i < size; i += 3) png.palette.push_back({data[i], data[i + 1], data[i + 2], 255});
    } else if (name == "tRNS") {
      REQUIRE(size <= png.palette.size());
      for (uint32_t i = 0; i < size; ++i) png.palette[i][3] = data[i];
    } else if (name == "IDAT") {
      packed.insert(packed.end(), data.begin(), data.end());
    }
    at += 12 + size;
  }
  REQUIRE(png.chunks.front() == "IHDR");
  REQUIRE(png.chunks.back() == "IEND");

  const size_t pixel_bits = png.kind == 3 ? static_cast<size_t>(png.bits) : 32, line = (png.width * pixel_bits + 7) / 8;
  const Bytes raw = inflate_all(packed, (line + 1) * png.height);
  Bytes above(line, 0);
  for (uint32_t r = 0; r < png.height; ++r) {
    const std::span<const uint8_t> in = std::span(raw).subspan(r * (line + 1), line + 1);
    REQUIRE((in[0] == 0 || in[0] == 2));
    for (size_t i = 0; i < line; ++i) above[i] = static_cast<uint8_t>(in[i + 1] + (in[0] == 2 ? above[i] : 0));
    std::vector<Rgba> row;
    for (uint32_t i = 0; i < png.width; ++i) {
      if (png.kind == 6) {
        row.push_back({above[4 * i], above[4 * i + 1], above[4 * i + 2], above[4 * i + 3]});
        continue;
      }
      const size_t bit = i * pixel_bits;
      row.push_back(png.palette.at(above[bit / 8] >> (8 - pixel_bits - bit % 8) & ((1u << pixel_bits) - 1)));
    }
    if (const size_t used = png.width * pixel_bits % 8; used != 0) REQUIRE((above.back() & (0xFFu >> used)) == 0);
    png.rows.push_back(std::move(row));
  }
  return png;
}

// A grid of one cell with these colours of materials; labels are materials.
Metadata with_colors(const std::vector<std::string>& colors) {
  Metadata meta;
  for (uint32_t i = 0; i < colors.size(); ++i) {
    meta.materials.push_back({fmt::format("material {}", i), colors[i], i});
    meta.labels.push_back({i, ""});
  }
  return meta;
}

// `count` different colours, the first one transparent if asked.
Metadata with_colors(size_t count, bool transparent) {
  std::vector<std::string> colors;
  for (size_t i = 0; i < count; ++i) colors.push_back(fmt::format("#{:06x}", i * 2654435761u >> 8 & 0xFFFFFF));
  if (transparent) colors[0] += "00";
  return with_colors(colors);
}

using Rows = std::vector<std::vector<uint16_t>>;

Bytes encode(const Rows& rows, const SetColors& colors) {
  Bytes file;
  PngWriter png(static_cast<uint32_t>(rows[0].size()), static_cast<uint32_t>(rows.size()), colors,
                [&](std::span<const uint8_t> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  for (const auto& row : rows) png.row(row);
  png.finish();
  return file;
}

void require_same(const Png& png, const Rows& rows, const SetColors& colors) {
  const std::vector<Rgba> known = colors.colors();
  REQUIRE(png.width == rows[0].size());
  REQUIRE(png.height == rows.size());
  for (size_t r = 0; r < rows.size(); ++r)
    for (size_t i = 0; i < rows[r].size(); ++i)
      if (png.rows[r][i] != known[rows[r][i]]) FAIL("row " << r << " pixel " << i);
}

// Noise, stretches, and rows that repeat.
Rows rows_of(size_t width, size_t height, size_t colors, std::mt19937_64& random) {
  Rows rows;
  std::vector<uint16_t> row(width);
  for (size_t r = 0; r < height; ++r) {
    const auto what = random() % 3;
    for (size_t i = 0; i < width && what != 0; ++i)
      row[i] = what == 2 && i > 0 && random() % 8 != 0 ? row[i - 1] : static_cast<uint16_t>(random() % colors);
    rows.push_back(row);
  }
  return rows;
}

}  // namespace

TEST_CASE("A colour is six or eight hex digits after #") {
  CHECK(parse_color("#8899aa") == Rgba{0x88, 0x99, 0xAA, 255});
  CHECK(parse_color("#00FF7f80") == Rgba{0, 255, 127, 128});
  for (const char* wrong : {"", "#", "8899aa", "#8899a", "#8899aab", "#8899aabbc", "#8899ag", "#8899aa\n"})
    CHECK_THROWS_AS(parse_color(wrong), FormatError);
}

TEST_CASE("A blend is the mean of premultiplied colours, half up, divided by the mean alpha") {
  const Rgba black = {0, 0, 0, 255}, white = {255, 255, 255, 255}, red = {255, 0, 0, 255}, nothing = {0, 0, 0, 0};
  const auto of = [](std::vector<Rgba> colors) { return blend(colors); };
  CHECK(of({{1, 2, 3, 4}}) == Rgba{1, 2, 3, 4});                 // one colour stays what it is
  CHECK(of({black, white}) == Rgba{128, 128, 128, 255});         // 127.5 up
  CHECK(of({black, white, white}) == Rgba{170, 170, 170, 255});  // 510 / 3
  CHECK(of({black, black, white}) == Rgba{85, 85, 85, 255});
  CHECK(of({red, nothing}) == Rgba{255, 0, 0, 128});             // 127.5 up over 127.5 up: still fully red
  CHECK(of({nothing, nothing}) == nothing);
  // A transparent colour has no say in the channels, whatever it is.
  CHECK(of({red, {0, 255, 0, 0}}) == of({red, nothing}));
  // 200 * 128 / 255 = 100.39, 100 * 128 / 255 = 50.2, 10 * 128 / 255 = 5.02: premultiplied (100, 50, 5, 128).
  // With (0, 0, 255, 255): means 50, 25, 130, 191.5 up = 192; times 255 / 192: 66.4, 33.2, 172.66.
  CHECK(of({{200, 100, 10, 128}, {0, 0, 255, 255}}) == Rgba{66, 33, 173, 192});
  // Rounding can lift a mean channel above the mean alpha, 0.5 up to 1 over 0.5 up to 1 here: never past 255.
  CHECK(of({{255, 0, 0, 1}, nothing}) == Rgba{255, 0, 0, 1});
}

TEST_CASE("A blend does not depend on the order of the colours") {
  std::mt19937_64 random(3);
  for (int i = 0; i < 1000; ++i) {
    std::vector<Rgba> colors(2 + random() % 6);
    for (Rgba& c : colors)
      for (uint8_t& channel : c) channel = static_cast<uint8_t>(random());
    const Rgba before = blend(colors);
    std::ranges::shuffle(colors, random);
    REQUIRE(blend(colors) == before);
  }
}

TEST_CASE("On level 0 every material has its colour, and equal colours share a number") {
  const Metadata meta = with_colors({"#00000000", "#112233", "#445566", "#112233ff"});
  SetColors colors(meta, 0);
  CHECK(colors.complete());
  CHECK(colors.colors() == std::vector<Rgba>{{0, 0, 0, 0}, {0x11, 0x22, 0x33, 255}, {0x44, 0x55, 0x66, 255}});
  CHECK(colors.number({3}) == colors.number({1}));
  CHECK(colors.number({2}) == 2);
}

TEST_CASE("On coarser levels up to 8 materials have a palette of all their sets") {
  const Metadata meta = with_colors(8, true);
  SetColors colors(meta, 1);
  CHECK(colors.complete());
  const std::vector<Rgba> before = colors.colors();
  CHECK(before.size() <= 255);
  for (uint32_t members = 1; members < 256; ++members) {
    std::vector<Label> set;
    std::vector<Rgba> mixed;
    for (uint32_t m = 0; m < 8; ++m) {
      if (!(members >> m & 1)) continue;
      set.push_back(m);
      mixed.push_back(parse_color(meta.materials[m].color));
    }
    REQUIRE(before[colors.number(set)] == blend(mixed));
  }
  CHECK(colors.colors() == before);
}

TEST_CASE("Labels of one material weigh once, however many bodies carry it") {
  Metadata meta = with_colors({"#000000", "#ffffff"});
  meta.labels = {{0, ""}, {1, "a"}, {1, "b"}, {1, "c"}};
  SetColors colors(meta, 1);
  CHECK(colors.colors()[colors.number({0, 1, 2, 3})] == Rgba{128, 128, 128, 255});
  CHECK(colors.number({1, 2}) == colors.number({3}));
}

TEST_CASE("With more materials colours are numbered as sets turn up, from any thread", "[threads]") {
  const Metadata meta = with_colors(40, false);
  SetColors colors(meta, 2);
  CHECK_FALSE(colors.complete());
  {
    std::vector<std::jthread> pool;
    for (int t = 0; t < 4; ++t)
      pool.emplace_back([&] {
        for (Label a = 0; a < 40; ++a)
          for (Label b = a + 1; b < 40; ++b) colors.number({a, b});
      });
  }
  const std::vector<Rgba> known = colors.colors();
  for (Label a = 0; a < 40; ++a)
    for (Label b = a + 1; b < 40; ++b) {
      const std::vector<Rgba> two = {parse_color(meta.materials[a].color), parse_color(meta.materials[b].color)};
      REQUIRE(known[colors.number({a, b})] == blend(two));
    }
  CHECK(colors.colors().size() == known.size());
}

TEST_CASE("A PNG takes the fewest bits a pixel that its palette allows, and decodes to its rows") {
  std::mt19937_64 random(1);
  const auto [count, bits, kind] = GENERATE(table<size_t, int, int>({{1, 1, 3}, {2, 1, 3}, {3, 2, 3}, {4, 2, 3}, {5, 4, 3}, {16, 4, 3}, {17, 8, 3}, {256, 8, 3}, {257, 8, 6}, {5000, 8, 6}}));
  const Metadata meta = with_colors(count, true);  // colours keep a reference
  SetColors colors(meta, 0);
  for (const size_t width : {1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 33, 1000}) {
    const Rows rows = rows_of(width, 1 + random() % 20, count, random);
    const Png png = decode(encode(rows, colors));
    REQUIRE(png.bits == bits);
    REQUIRE(png.kind == kind);
    require_same(png, rows, colors);
  }
}

TEST_CASE("tRNS is there only for a palette with transparency, and ends with its last transparent entry") {
  const auto chunks = [](const std::vector<std::string>& c) {
    const Metadata meta = with_colors(c);
    SetColors colors(meta, 0);
    return decode(encode({{0}}, colors));
  };
  CHECK(chunks({"#102030", "#405060"}).chunks == std::vector<std::string>{"IHDR", "PLTE", "IDAT", "IEND"});
  const Png first = chunks({"#00000000", "#405060", "#708090"});
  CHECK(first.chunks == std::vector<std::string>{"IHDR", "PLTE", "tRNS", "IDAT", "IEND"});
  CHECK(first.sizes[2] == 1);
  const Png last = chunks({"#102030", "#40506080", "#708090"});
  CHECK(last.sizes[2] == 2);
  CHECK(last.palette[1] == Rgba{0x40, 0x50, 0x60, 0x80});
}

TEST_CASE("Colours that turn up while rows are written are in the picture") {
  const Metadata meta = with_colors(12, false);
  SetColors colors(meta, 1);
  Bytes file;
  PngWriter png(3, 12, colors, [&](std::span<const uint8_t> bytes) { file.insert(file.end(), bytes.begin(), bytes.end()); });
  Rows rows;
  for (Label m = 0; m < 12; ++m) {
    rows.push_back({colors.number({m}), colors.number({0, m}), colors.number({m, 11})});
    png.row(rows.back());
  }
  png.finish();
  require_same(decode(file), rows, colors);
}

TEST_CASE("Large pictures come in pieces of 64 KiB, with rows larger than a piece") {
  std::mt19937_64 random(2);
  const Metadata meta = with_colors(256, false);
  SetColors colors(meta, 0);
  Rows rows(3, std::vector<uint16_t>(200'000));
  for (auto& row : rows)
    for (uint16_t& number : row) number = static_cast<uint16_t>(random() % 256);
  const Png png = decode(encode(rows, colors));
  require_same(png, rows, colors);
  for (size_t i = 0; i + 2 < png.chunks.size(); ++i)
    if (png.chunks[i] == "IDAT") CHECK(png.sizes[i] == 1 << 16);
}

}  // namespace teracell
