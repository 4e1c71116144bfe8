// Tiles are decoded: every pixel has its colour, whatever the runs, the row lengths and the number of colours.
#include "server/picture/tile_png.hpp"

#include "tests/support/png.hpp"

namespace teracell::server {
namespace {

using Numbers = std::vector<uint16_t>;
using Random = std::mt19937;

std::vector<Rgba> different_colors(uint32_t count) {
  std::vector<Rgba> colors;
  for (uint32_t i = 0; i < count; ++i)
    colors.push_back({static_cast<uint8_t>(i), static_cast<uint8_t>(i >> 8), 7, static_cast<uint8_t>(i % 3 == 0 ? i : 255)});
  return colors;
}

testing::Decoded require_tile(uint32_t width, uint32_t height, const Numbers& numbers, const std::vector<Rgba>& colors) {
  const std::string png = encode_png(width, height, numbers, colors);
  const auto d = testing::decode({reinterpret_cast<const uint8_t*>(png.data()), png.size()});
  REQUIRE((d.width == width && d.height == height && d.rows.size() == height));
  size_t wrong = 0;
  for (uint32_t r = 0; r < height; ++r)
    for (uint32_t i = 0; i < width; ++i) wrong += d.rows[r][i] != colors[numbers[size_t{r} * width + i]];
  REQUIRE(wrong == 0);
  const size_t used = std::set<uint16_t>(numbers.begin(), numbers.end()).size();
  REQUIRE(d.kind == (used <= 256 ? 3 : 6));
  if (used <= 256) REQUIRE(d.bits == (used <= 2 ? 1 : used <= 4 ? 2 : used <= 16 ? 4 : 8));
  return d;
}

// ---- pictures

Numbers noise_numbers(Random& random, uint32_t width, uint32_t height, uint32_t numbers) {
  Numbers out(size_t{width} * height);
  for (auto& n : out) n = static_cast<uint16_t>(random() % numbers);
  return out;
}

// Stretches of all lengths along rows; some rows equal the one above, some equal it except for a few pixels.
Numbers runs(Random& random, uint32_t width, uint32_t height, uint32_t numbers) {
  Numbers out;
  for (uint32_t r = 0; r < height; ++r) {
    const uint32_t kind = r == 0 ? 0 : random() % 4;
    if (kind == 0) {
      while (out.size() < size_t{r + 1} * width) {
        const size_t left = size_t{r + 1} * width - out.size();
        out.insert(out.end(), std::min<size_t>(left, 1 + random() % (1u << random() % 10)), static_cast<uint16_t>(random() % numbers));
      }
    } else {
      for (uint32_t i = 0; i < width; ++i) out.push_back(out[out.size() - width]);
      for (uint32_t k = 1; k < kind; ++k) out[out.size() - 1 - random() % width] = static_cast<uint16_t>(random() % numbers);
    }
  }
  return out;
}

// Rings around a centre: boundaries of every slope.
Numbers rings(uint32_t width, uint32_t height, uint32_t numbers) {
  Numbers out;
  for (uint32_t r = 0; r < height; ++r)
    for (uint32_t i = 0; i < width; ++i) {
      const int64_t x = int64_t{i} - 200, y = int64_t{r} - 150;
      out.push_back(static_cast<uint16_t>((x * x + y * y) / 4000 % numbers));
    }
  return out;
}

TEST_CASE("tiles of every width and number of colours are decoded to the same pixels", "[server][long]") {
  Random random(1);
  for (const uint32_t count : {1u, 2u, 3u, 4u, 5u, 16u, 17u, 256u, 257u, 1000u}) {
    const auto colors = different_colors(count);
    for (uint32_t width = 1; width <= 70; ++width) {
      INFO(count << " colours, width " << width);
      require_tile(width, 9, noise_numbers(random, width, 9, count), colors);
      require_tile(width, 23, runs(random, width, 23, count), colors);
    }
    INFO(count << " colours");
    require_tile(512, 512, noise_numbers(random, 512, 512, count), colors);
    require_tile(512, 512, runs(random, 512, 512, count), colors);
    require_tile(512, 512, rings(512, 512, count), colors);
    require_tile(512, 512, Numbers(512 * 512, static_cast<uint16_t>(count - 1)), colors);
    require_tile(1, 512, runs(random, 1, 512, count), colors);
  }
}

TEST_CASE("only colours that occur are in the palette", "[server]") {
  const auto colors = different_colors(300);
  Numbers numbers(512 * 512, 299);
  auto d = require_tile(512, 512, numbers, colors);
  REQUIRE((d.bits == 1 && d.palette == std::vector<Rgba>{colors[299]}));
  numbers.back() = 7;
  d = require_tile(512, 512, numbers, colors);
  REQUIRE((d.bits == 1 && d.palette == std::vector<Rgba>{colors[7], colors[299]}));
  numbers[5] = 8, numbers[512 * 300 + 200] = 9;
  d = require_tile(512, 512, numbers, colors);
  REQUIRE((d.bits == 2 && d.palette.size() == 4));
}

TEST_CASE("equal colours share a place in the palette", "[server]") {
  Random random(4);
  auto colors = different_colors(300);
  for (size_t n = 0; n < 300; ++n) colors[n] = colors[n % 4];
  const Numbers numbers = noise_numbers(random, 65, 30, 300);
  const std::string png = encode_png(65, 30, numbers, colors);
  const auto d = testing::decode({reinterpret_cast<const uint8_t*>(png.data()), png.size()});
  REQUIRE((d.bits == 2 && d.palette.size() == 4));
  for (size_t i = 0; i < numbers.size(); ++i) REQUIRE(d.rows[i / 65][i % 65] == colors[numbers[i]]);
}

// A match can reach the row above only if a row of the stream has at most 32768 bytes.
TEST_CASE("rows as long as a match can reach back, a bit shorter and longer", "[server]") {
  Random random(2);
  const auto around = [&](uint32_t bits, uint32_t count) {
    for (const int more : {-9, -8, -1, 0, 1, 8, 9, 70000}) {
      if (kSanitized && more != 0 && more != 9) continue;
      const auto width = static_cast<uint32_t>(32767 * 8 / static_cast<int>(bits) + more);
      INFO(bits << " bits, width " << width);
      const auto colors = different_colors(count);
      require_tile(width, 5, runs(random, width, 5, count), colors);
      require_tile(width, 3, noise_numbers(random, width, 3, count), colors);
      require_tile(width, 3, Numbers(size_t{width} * 3, 0), colors);
    }
  };
  around(1, 2);
  around(4, 16);
  around(8, 256);
  around(32, 257);
}

// Matches are 3 to 258 bytes long: stretches of all lengths up to and around the multiples of these.
TEST_CASE("stretches of every length", "[server]") {
  const auto colors = different_colors(256);
  for (uint32_t stretch = 1; stretch <= 1100; ++stretch) {
    Numbers numbers(1500 * 2, 1);
    for (uint32_t i = 0; i < 256; ++i) numbers[i] = static_cast<uint16_t>(i);  // 8 bits: one byte per number
    std::fill_n(numbers.begin() + 300, stretch, uint16_t{2});  // a run; in the row below all but its ends equals the row above
    std::copy_n(numbers.begin(), 1500, numbers.begin() + 1500);
    numbers[1500 + 299] = numbers[1500 + 300 + stretch] = 3;
    INFO("stretch " << stretch);
    require_tile(1500, 2, numbers, colors);
  }
}

// Counts that grow like Fibonacci numbers give the deepest Huffman codes, which must be limited to 15 bits.
TEST_CASE("colours of very unequal frequency", "[server]") {
  Numbers numbers;
  uint32_t a = 1, b = 1;
  for (uint16_t n = 0; n < 24; ++n) {
    numbers.insert(numbers.end(), a, n);
    b += a, a = b - a;
  }
  Random random(3);
  std::shuffle(numbers.begin(), numbers.end(), random);
  const auto height = static_cast<uint32_t>(numbers.size() / 300);
  numbers.resize(size_t{height} * 300);
  require_tile(300, height, numbers, different_colors(24));
}

TEST_CASE("a tile whose rows repeat takes almost no bytes", "[server]") {
  const auto colors = different_colors(300);
  REQUIRE(encode_png(512, 512, Numbers(512 * 512, 1), colors).size() < 256);
  Numbers stripes;
  for (uint32_t i = 0; i < 512 * 512; ++i) stripes.push_back(static_cast<uint16_t>(i % 512 / 40));
  // 511 rows of 257 bytes are 509 matches of 9 bits: 1 for the length, 1 for the distance, 7 to complete it.
  REQUIRE(encode_png(512, 512, stripes, colors).size() < 509 * 9 / 8 + 200);
  // A boundary down the picture takes less than one byte per row.
  const Numbers circles = rings(512, 512, 2);
  size_t boundaries = 0;
  for (size_t i = 1; i < circles.size(); ++i) boundaries += i % 512 != 0 && circles[i] != circles[i - 1];
  REQUIRE(boundaries > 10000);
  REQUIRE(encode_png(512, 512, circles, colors).size() < boundaries);
}

}  // namespace
}  // namespace teracell::server
