// What the pixels show, as numbers, against the picture of the same pixels.
#include "server/render/sights.hpp"

#include "server/render/options.hpp"
#include "store/base/bytes.hpp"
#include "store/read/kept_chunks.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

// As server/SERVING.md has it.
struct Decoded {
  uint32_t width, height;
  std::vector<uint32_t> label;  // 0: nothing
  std::vector<double> distance;
  std::vector<Light> light;
  std::map<size_t, std::array<Seen, 4>> edges;
};

Decoded decoded(const std::string& text, bool perspective) {
  ByteReader in({reinterpret_cast<const uint8_t*>(text.data()), text.size()}, "sights");
  const auto magic = in.take(4);
  REQUIRE(std::string(magic.begin(), magic.end()) == "TCS1");
  Decoded out{in.fixed<uint32_t>(), in.fixed<uint32_t>(), {}, {}, {}, {}};
  const auto edges = in.fixed<uint32_t>();
  const auto nearest = std::bit_cast<double>(in.fixed<uint64_t>()), farthest = std::bit_cast<double>(in.fixed<uint64_t>());
  const auto label_bytes = in.fixed<uint64_t>();
  const size_t n = size_t{out.width} * out.height;
  const auto label = [&] {
    uint32_t code = 0;
    for (uint64_t i = 0; i < label_bytes; ++i) code |= uint32_t{in.fixed<uint8_t>()} << (8 * i);
    return code;
  };
  for (size_t i = 0; i < n; ++i) out.label.push_back(label());
  const auto low = in.take(n), high = in.take(n), own = in.take(n), added = in.take(n), facing = in.take(n);
  out.light.resize(n);
  for (size_t y = 0; y < out.height; ++y) {
    uint16_t distance = 0;
    uint8_t o = 0, a = 0, f = 0;
    for (size_t i = y * out.width; i < (y + 1) * out.width; ++i) {
      distance = static_cast<uint16_t>(distance + low[i] + 256 * high[i]);
      const double share = (distance - 1) / 65534.0;
      out.distance.push_back(perspective ? nearest * std::pow(farthest / nearest, share) : nearest + share * (farthest - nearest));
      o = static_cast<uint8_t>(o + own[i]), a = static_cast<uint8_t>(a + added[i]), f = static_cast<uint8_t>(f + facing[i]);
      out.light[i] = {static_cast<float>(o / 160.0), static_cast<float>(a / 1275.0), static_cast<float>(f / 255.0)};
    }
  }
  const auto bits = in.take((n + 7) / 8);
  std::vector<size_t> places;
  for (size_t i = 0; i < n; ++i)
    if (bits[i / 8] >> (i % 8) & 1) places.push_back(i);
  REQUIRE(places.size() == edges);
  for (const size_t at : places)
    for (Seen& s : out.edges[at]) s.label = label() - 1;
  for (const size_t at : places)
    for (Seen& s : out.edges[at]) s.light.own = static_cast<float>(in.fixed<uint8_t>() / 160.0);
  for (const size_t at : places)
    for (Seen& s : out.edges[at]) s.light.added = static_cast<float>(in.fixed<uint8_t>() / 1275.0);
  for (const size_t at : places)
    for (Seen& s : out.edges[at]) s.light.facing = static_cast<float>(in.fixed<uint8_t>() / 255.0);
  in.expect_end();
  return out;
}

struct Balls {
  TempFolder folder;
  GridReader reader;
  Balls(std::mt19937_64& random, int ray_axis) : reader(stored(random, ray_axis)) {}
  GridReader stored(std::mt19937_64& random, int ray_axis) {
    std::vector<Label> cells(40 * 40 * 40);
    for (int ball = 0; ball < 5; ++ball) {
      const int64_t x = static_cast<int64_t>(random() % 40), y = static_cast<int64_t>(random() % 40), z = static_cast<int64_t>(random() % 40);
      for (int64_t i = 0; i < 64000; ++i) {
        const int64_t dx = i % 40 - x, dy = i / 40 % 40 - y, dz = i / 1600 - z;
        if (dx * dx + dy * dy + dz * dz < 80) cells[static_cast<size_t>(i)] = static_cast<Label>(1 + ball % 2);
      }
    }
    store_cells(folder / "g", metadata_of(cube_grid(-1, 2, 40), ray_axis, 3), cells);
    return GridReader(std::make_unique<InputFile>(folder / "g"), std::make_shared<KeptChunks>(1 << 20));
  }
};

RenderOptions options_of(const GridReader& reader, const std::map<std::string, std::string, std::less<>>& words) {
  return parse_render_options(
      [&](std::string_view name) -> const std::string* {
        const auto it = words.find(name);
        return it == words.end() ? nullptr : &it->second;
      },
      reader, "--");
}

TEST_CASE("the numbers have the colours of the picture", "[render]") {
  std::mt19937_64 random(1911);
  for (const auto& words : std::vector<std::map<std::string, std::string, std::less<>>>{{{"size", "97,61"}},
                                                                                        {{"size", "60,60"}, {"view", "y"}},
                                                                                        {{"size", "80,50"}, {"open", "0.5,0.5,0.5"}},
                                                                                        {{"size", "50,50"}, {"plane", "1,1,0,1"}}}) {
    const Balls scene(random, static_cast<int>(random() % 3));
    const RenderOptions options = options_of(scene.reader, words);
    const Picture3D picture = render(scene.reader, options, 1, [](double) {});
    const Prepared prepared(scene.reader, shown_labels(scene.reader.meta(), options), 0, 1);
    const PictureSize size = options.aim.camera.size;
    const Window all{0, 0, size.width, size.height};
    const Decoded numbers = decoded(encode_sights(scene.reader, prepared, options.aim, all, false, 2, [](double) {}), options.aim.camera.perspective);
    REQUIRE(numbers.width == size.width);
    REQUIRE(numbers.height == size.height);
    CHECK(numbers.edges.size() > 20);
    const auto color = [&](uint32_t label, const Light& light) {
      if (label == Sample::kNothing) return options.ground;
      return lit(*parse_color(scene.reader.meta().materials[label].color), light);
    };
    for (size_t i = 0; i < numbers.label.size(); ++i) {
      std::array<double, 3> expected{};
      const auto edge = numbers.edges.find(i);
      if (edge == numbers.edges.end()) {
        const Rgba c = color(numbers.label[i] - 1, numbers.light[i]);
        for (size_t k = 0; k < 3; ++k) expected[k] = c[k];
      } else
        for (const Seen& s : edge->second)
          for (size_t k = 0; k < 3; ++k) expected[k] += color(s.label, s.light)[k] / 4.0;
      CAPTURE(i);
      for (size_t k = 0; k < 3; ++k) REQUIRE(std::abs(picture.rgba[4 * i + k] - expected[k]) <= 4);  // light has steps
      // What is seen at the middle of the pixel, and how far away.
      const double x = static_cast<double>(i % size.width) + 0.5, y = static_cast<double>(i / size.width) + 0.5;
      const auto hit = seen_at(scene.reader, prepared, options.aim, x, y);
      REQUIRE(hit.has_value() == (numbers.label[i] != 0));
      if (!hit) continue;
      REQUIRE(hit->label + 1 == numbers.label[i]);
      REQUIRE(numbers.distance[i] == Approx(hit->t).epsilon(1e-3));
      REQUIRE(numbers.light[i].facing >= 0);
      REQUIRE(numbers.light[i].facing <= 1);
    }
  }
}

TEST_CASE("the windows of a picture, side by side, are the picture; threads make no difference", "[render][threads]") {
  std::mt19937_64 random(1912);
  const Balls scene(random, 1);
  const RenderOptions options = options_of(scene.reader, {{"size", "90,70"}});
  const Prepared prepared(scene.reader, shown_labels(scene.reader.meta(), options), 0, 1);
  const auto numbers = [&](const Window& window, int threads) {
    return decoded(encode_sights(scene.reader, prepared, options.aim, window, false, threads, [](double) {}), true);
  };
  const Decoded all = numbers({0, 0, 90, 70}, 3);
  for (const Window& window : {Window{0, 0, 33, 70}, Window{33, 0, 90, 41}, Window{33, 41, 90, 70}, Window{89, 69, 90, 70}}) {
    const Decoded part = numbers(window, 1);
    for (int64_t y = window.y0; y < window.y1; ++y)
      for (int64_t x = window.x0; x < window.x1; ++x) {
        const auto i = static_cast<size_t>(y * 90 + x), j = static_cast<size_t>((y - window.y0) * window.width() + x - window.x0);
        CAPTURE(x, y);
        REQUIRE(part.label[j] == all.label[i]);
        REQUIRE(part.light[j].own == all.light[i].own);
        REQUIRE(part.light[j].added == all.light[i].added);
        REQUIRE(part.edges.contains(j) == all.edges.contains(i));
      }
  }
  const Decoded quick = decoded(encode_sights(scene.reader, prepared, options.aim, {0, 0, 90, 70}, true, 1, [](double) {}), true);
  CHECK(quick.edges.empty());
  CHECK(quick.label == all.label);
}

TEST_CASE("what can't be read is seen where it lies, as a label of its own, and all else as it is", "[render]") {
  std::mt19937_64 random(1913);
  for (int round = 0; round < 6; ++round) {
    const Grid grid = cube_grid(-1, 2, 24);
    const auto meta = [&](uint32_t labels) { return with_tiny_chunks(metadata_of(grid, round % 3, labels)); };
    std::vector<Label> cells = random_cells(random, grid.cells(), 3);
    for (Label& cell : cells) cell = random() % 4 ? 0 : cell;
    Bytes bytes = stored_cells(meta(3), cells);
    const GridReader sound = reader_of(bytes);
    const LevelShape shape = sound.shape(0);
    ChunkKey key{0, 0, 0, 0};
    for (int tries = 0; sound.entry(key)->size == 0 && tries < 1000; ++tries)
      key = {0, static_cast<uint32_t>(random() % shape.chunks_u), static_cast<uint32_t>(random() % shape.chunks_v),
             static_cast<uint32_t>(random() % shape.segments)};
    const auto entry = sound.entry(key);
    REQUIRE(entry->size > 0);
    bytes[entry->offset + entry->size / 2] ^= 1;
    const GridReader damaged = reader_of(bytes);
    // The same where all of the chunk is a label that is there nowhere else.
    const RayFrame frame = sound.meta().frame();
    for (size_t i = 0; i < cells.size(); ++i) {
      const std::array<uint32_t, 3> at = {static_cast<uint32_t>(i % 24), static_cast<uint32_t>(i / 24 % 24), static_cast<uint32_t>(i / 576)};
      if (at[frame.u] / shape.chunk_rays == key.cu && at[frame.v] / shape.chunk_rays == key.cv && at[frame.w] / shape.chunk_cells == key.segment)
        cells[i] = 3;
    }
    const GridReader filled = reader_of(meta(4), cells);
    const RenderOptions options = options_of(sound, {{"size", "60,50"}, {"level", "0"}});
    const Prepared prepared(damaged, {false, true, true}, 0, 1, true), expected(filled, {false, true, true, true}, 0, 1);
    REQUIRE(prepared.visible.damage() == 3);
    int seen = 0;
    for (double y = 0.5; y < 50; ++y)
      for (double x = 0.5; x < 60; ++x) {
        const auto hit = seen_at(damaged, prepared, options.aim, x, y), other = seen_at(filled, expected, options.aim, x, y);
        REQUIRE(hit.has_value() == other.has_value());
        if (!hit) continue;
        REQUIRE(hit->label == other->label);
        REQUIRE(hit->t == other->t);
        REQUIRE(hit->cell == other->cell);
        seen += hit->label == 3;
      }
    const Decoded numbers = decoded(encode_sights(damaged, prepared, options.aim, {0, 0, 60, 50}, true, 2, [](double) {}), true);
    CHECK(std::ranges::count(numbers.label, 4u) == seen);
    CHECK_THROWS_AS(Prepared(damaged, {false, true, true}, 0, 1), FormatError);
  }
}

TEST_CASE("nothing in sight, and an eye inside a body", "[render]") {
  const GridReader reader = reader_of(metadata_of(cube_grid(0, 1, 8), 0, 2), std::vector<Label>(512, 1));
  for (const auto& [words, label] : std::vector<std::pair<std::map<std::string, std::string, std::less<>>, uint32_t>>{
           {{{"size", "5,4"}, {"from", "0.5,0.5,0.5"}, {"at", "0.7,0.5,0.5"}}, 2}, {{{"size", "5,4"}, {"labels", ""}}, 0}}) {
    const RenderOptions options = options_of(reader, words);
    const Prepared prepared(reader, shown_labels(reader.meta(), options), 0, 1);
    const Decoded numbers = decoded(encode_sights(reader, prepared, options.aim, {0, 0, 5, 4}, false, 1, [](double) {}), true);
    CHECK(numbers.label == std::vector<uint32_t>(20, label));
    if (label) CHECK(numbers.distance == std::vector<double>(20, 0));
  }
}

}  // namespace
}  // namespace teracell::server
