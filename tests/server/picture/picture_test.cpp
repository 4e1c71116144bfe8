// Pictures are decoded: every pixel has its colour, whatever the number of bits per pixel.
#include "server/picture/picture.hpp"

#include "tests/support/png.hpp"

namespace teracell::server {
namespace {

using Rows = std::vector<std::vector<uint16_t>>;
using testing::decode;
using testing::Decoded;

// ---- what is written

// One material per colour, one label per material.
Metadata with_colors(const std::vector<std::string>& colors) {
  Metadata meta;
  for (const std::string& color : colors) {
    meta.labels.push_back({static_cast<uint32_t>(meta.materials.size()), ""});
    meta.materials.push_back({fmt::format("m{}", meta.materials.size()), color, 0});
  }
  return meta;
}

std::vector<std::string> different_color_texts(uint32_t count, uint32_t alpha = 255) {
  std::vector<std::string> colors;
  for (uint32_t i = 0; i < count; ++i) {
    char text[10];
    std::snprintf(text, sizeof text, "#%06x%02x", i * 40503 % 0xFFFFFF, alpha);
    colors.push_back(text);
  }
  return colors;
}

std::vector<uint8_t> write(uint32_t width, const SetColors& colors, const Rows& rows) {
  std::vector<uint8_t> png;
  PngWriter writer(width, static_cast<uint32_t>(rows.size()), colors, [&](std::span<const uint8_t> b) { png.insert(png.end(), b.begin(), b.end()); });
  for (const auto& row : rows) writer.append(row);
  writer.finish();
  return png;
}

// Rows of noise, every third one like the row before.
Rows noise(std::mt19937& random, uint32_t width, uint32_t height, uint32_t numbers) {
  Rows rows;
  for (uint32_t r = 0; r < height; ++r) {
    if (r % 3 == 2) {
      rows.push_back(rows.back());
      continue;
    }
    auto& row = rows.emplace_back(width);
    for (auto& n : row) n = static_cast<uint16_t>(random() % numbers);
  }
  return rows;
}

void require_picture(const Decoded& d, const SetColors& colors, const Rows& rows) {
  const auto known = colors.colors();
  REQUIRE(d.height == rows.size());
  for (size_t r = 0; r < rows.size(); ++r) {
    REQUIRE(d.width == rows[r].size());
    bool same = true;
    for (size_t i = 0; i < rows[r].size(); ++i) same &= d.rows[r][i] == known[rows[r][i]];
    INFO("row " << r);
    REQUIRE(same);
  }
}

TEST_CASE("a picture has as few bits per pixel as its number of colours allows", "[server]") {
  std::mt19937 random(1);
  const std::pair<uint32_t, int> cases[] = {{1, 1}, {2, 1}, {3, 2}, {4, 2}, {5, 4}, {16, 4}, {17, 8}, {255, 8}, {256, 8}};
  for (const auto& [count, bits] : cases) {
    const Metadata meta = with_colors(different_color_texts(count));
    const SetColors colors(meta, 0);
    for (const uint32_t width : {1u, 2u, 3u, 4u, 5u, 7u, 8u, 9u, 15u, 16u, 17u, 63u, 64u, 65u, 1001u}) {
      INFO(count << " colours, width " << width);
      const Rows rows = noise(random, width, 8, count);
      const Decoded d = decode(write(width, colors, rows));
      REQUIRE((d.kind == 3 && d.bits == bits));
      REQUIRE(d.palette == colors.colors());
      require_picture(d, colors, rows);
    }
  }
}

TEST_CASE("pictures of more than 256 colours are RGBA", "[server]") {
  std::mt19937 random(2);
  for (const uint32_t alpha : {255u, 77u}) {
    const Metadata meta = with_colors(different_color_texts(257, alpha));
    const SetColors colors(meta, 0);
    for (const uint32_t width : {1u, 7u, 301u}) {
      const Rows rows = noise(random, width, 8, 257);
      const Decoded d = decode(write(width, colors, rows));
      REQUIRE((d.kind == 6 && d.bits == 8));
      require_picture(d, colors, rows);
    }
  }
}

TEST_CASE("equal colours share a number", "[server]") {
  const Metadata meta = with_colors(std::vector<std::string>(300, "#102030"));
  const SetColors colors(meta, 0);
  REQUIRE(colors.colors().size() == 1);
  REQUIRE(colors.complete());
}

TEST_CASE("tRNS ends with the last colour that is not opaque", "[server]") {
  const std::pair<std::vector<std::string>, size_t> cases[] = {{{"#000000", "#ffffff"}, 0},
                                                               {{"#00000000", "#ffffff", "#102030ff"}, 1},
                                                               {{"#000000", "#ffffff80", "#102030"}, 2},
                                                               {{"#000000", "#ffffff", "#10203000"}, 3}};
  for (const auto& [texts, alphas] : cases) {
    const Metadata meta = with_colors(texts);
    const SetColors colors(meta, 0);
    Rows rows(1);
    for (uint16_t i = 0; i < texts.size(); ++i) rows[0].push_back(i);
    const Decoded d = decode(write(static_cast<uint32_t>(texts.size()), colors, rows));
    REQUIRE(d.alphas == alphas);
    require_picture(d, colors, rows);
  }
}

TEST_CASE("a row may be longer than a chunk of data", "[server]") {
  std::mt19937 random(3);
  for (const uint32_t count : {2u, 256u, 300u}) {
    const Metadata meta = with_colors(different_color_texts(count));
    const SetColors colors(meta, 0);
    const uint32_t width = count == 2 ? 1000003 : 200003;
    const Rows rows = noise(random, width, 5, count);
    const Decoded d = decode(write(width, colors, rows));
    REQUIRE(d.data_chunks > rows.size() / 2);
    require_picture(d, colors, rows);
  }
}

TEST_CASE("a row may come in parts", "[server]") {
  std::mt19937 random(4);
  const Metadata meta = with_colors(different_color_texts(5));
  const SetColors colors(meta, 0);
  const Rows rows = noise(random, 301, 9, 5);
  std::vector<uint8_t> png;
  PngWriter writer(301, 9, colors, [&](std::span<const uint8_t> b) { png.insert(png.end(), b.begin(), b.end()); });
  for (const auto& row : rows)
    for (size_t at = 0, size; at < row.size(); at += size) {
      size = std::min<size_t>(row.size() - at, 1 + random() % 200);
      writer.append(std::span(row).subspan(at, size));
    }
  writer.finish();
  REQUIRE(png == write(301, colors, rows));
}

TEST_CASE("rows that are too long to keep give the same picture, in parts of any length", "[server]") {
  std::mt19937 random(5);
  for (const uint32_t count : {2u, 3u, 9u, 200u, 300u}) {
    const Metadata meta = with_colors(different_color_texts(count, 77));
    const SetColors colors(meta, 0);
    const std::vector<Rgba> palette = colors.complete() ? colors.colors() : std::vector<Rgba>();
    std::vector<uint32_t> value;
    for (uint32_t n = 0; n < count; ++n) value.push_back(palette.empty() ? PngFile::rgba(colors.colors()[n]) : n);
    for (const uint32_t width : {1u, 7u, 8u, 9u, 4001u, 100000u}) {
      INFO(count << " colours, width " << width);
      const Rows rows = noise(random, width, 6, count);
      std::vector<uint8_t> png;
      PngLongRows writer(width, 6, palette, [&](std::span<const uint8_t> b) { png.insert(png.end(), b.begin(), b.end()); });
      for (const auto& row : rows)
        for (size_t at = 0, size; at < row.size(); at += size) {
          size = std::min<size_t>(row.size() - at, 1 + random() % (random() % 2 ? 11 : 5000));
          writer.append(std::span(row).subspan(at, size), value.data());
        }
      writer.finish();
      const Decoded d = decode(png);
      REQUIRE(d.kind == (palette.empty() ? 6 : 3));
      require_picture(d, colors, rows);
    }
  }
}

TEST_CASE("rows that repeat take almost no bytes", "[server]") {
  const Metadata meta = with_colors({"#000000", "#ffffff"});
  const SetColors colors(meta, 0);
  const Rows rows(10000, std::vector<uint16_t>(1000, 1));
  const auto png = write(1000, colors, rows);
  REQUIRE(png.size() < 20000);  // of 1.26 million
  require_picture(decode(png), colors, rows);
}

TEST_CASE("the sets of a few materials have a palette; sets of many materials are numbered as they occur", "[server]") {
  const Metadata few = with_colors({"#00000000", "#ff0000", "#0000ff"});
  SetColors colors(few, 1);
  REQUIRE(colors.complete());
  REQUIRE(colors.colors()[colors.number({1, 2})] == Rgba{128, 0, 128, 255});
  REQUIRE(colors.colors()[colors.number({0, 1})] == Rgba{255, 0, 0, 128});
  REQUIRE(colors.number({0}) == 0);

  const Metadata many = with_colors(different_color_texts(9));
  SetColors growing(many, 1);
  REQUIRE_FALSE(growing.complete());
  const size_t before = growing.colors().size();
  std::vector<uint8_t> png;
  PngWriter writer(2, 2, growing, [&](std::span<const uint8_t> b) { png.insert(png.end(), b.begin(), b.end()); });
  Rows rows = {{0, 8}, {growing.number({1, 2, 3}), growing.number({0, 8})}};  // new ones after the writer has begun
  for (const auto& row : rows) writer.append(row);
  writer.finish();
  REQUIRE(growing.colors().size() == before + 2);
  const Decoded d = decode(png);
  REQUIRE(d.kind == 6);
  require_picture(d, growing, rows);
}

TEST_CASE("bodies of one material count once in a blend", "[server]") {
  Metadata meta = with_colors({"#000000", "#ffffff"});
  meta.labels = {{0, ""}, {1, "left"}, {1, "right"}};
  SetColors colors(meta, 1);
  REQUIRE(colors.colors()[colors.number({0, 1, 2})] == Rgba{128, 128, 128, 255});
  REQUIRE(colors.number({1}) == colors.number({1, 2}));
}

TEST_CASE("a blend is the mean of premultiplied colours, half up", "[server]") {
  const auto mix = [](std::vector<Rgba> colors) { return blend(colors); };
  REQUIRE(mix({{1, 2, 3, 4}}) == Rgba{1, 2, 3, 4});  // one colour stays what it is
  REQUIRE(mix({{255, 0, 0, 255}, {0, 0, 255, 255}}) == Rgba{128, 0, 128, 255});
  REQUIRE(mix({{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}}) == Rgba{85, 85, 85, 255});
  REQUIRE(mix({{255, 255, 255, 255}, {0, 0, 0, 0}}) == Rgba{255, 255, 255, 128});
  REQUIRE(mix({{255, 255, 255, 0}, {9, 9, 9, 0}}) == Rgba{0, 0, 0, 0});
  // #8899aa with nothing: halves 68, 77 (76.5 up), 85 under alpha 128; 68 * 255 / 128 = 135.5-, 153.4, 169.3.
  REQUIRE(mix({{0x88, 0x99, 0xaa, 255}, {0, 0, 0, 0}}) == Rgba{135, 153, 169, 128});
  // Premultiplied 100, 50, 25 with 10, 20, 30: 55, 35, 28 (27.5 up) under alpha 192 (191.5 up).
  REQUIRE(mix({{200, 100, 50, 128}, {10, 20, 30, 255}}) == Rgba{73, 46, 37, 192});
}

}  // namespace
}  // namespace teracell::server
