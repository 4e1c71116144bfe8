// Whole pictures.
#include "server/render/render.hpp"

#include "server/render/encode.hpp"
#include "server/render/options.hpp"
#include "store/read/kept_chunks.hpp"
#include "tests/support/cube_grid.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/png.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

Picture3D picture_of(const GridReader& reader, const std::map<std::string, std::string, std::less<>>& words, int threads = 1,
                     int64_t held = RenderOptions().held) {
  const auto text = [&](std::string_view name) -> const std::string* {
    const auto it = words.find(name);
    return it == words.end() ? nullptr : &it->second;
  };
  RenderOptions options = parse_render_options(text, reader, "--");
  options.held = held;
  return render(reader, options, threads, [](double) {});
}

Rgba pixel(const Picture3D& picture, int64_t x, int64_t y) {
  Rgba out;
  std::copy_n(&picture.rgba[static_cast<size_t>(4 * (y * picture.size.width + x))], 4, out.begin());
  return out;
}

GridReader stored_with_cache(const std::filesystem::path& file, size_t bytes = 1 << 20) {
  return GridReader(std::make_unique<InputFile>(file), std::make_shared<KeptChunks>(bytes));
}

TEST_CASE("flat views along the axes are the first materials of the columns", "[render]") {
  std::mt19937_64 random(1902);
  const TempFolder folder;
  const Index3 n = {13, 9, 11};
  constexpr uint32_t kLabels = 5;
  for (int ray_axis = 0; ray_axis < 3; ++ray_axis) {
    std::vector<Label> cells = random_cells(random, n, kLabels);
    for (Label& label : cells)
      if (random() % 3) label = 0;
    Metadata meta = with_tiny_chunks(
        metadata_of({{Axis::uniform(0, 1, 0, n[0], 0.5), Axis::uniform(-3, 1, 0, n[1], 0.5), Axis::uniform(0, 1, 2, n[2], 0.5)}}, ray_axis, kLabels));
    for (uint32_t m = 0; m < kLabels; ++m) meta.materials[m].color = fmt::format("#{:02x}{:02x}40", 40 * m, 255 - 50 * m);
    const auto file = folder / std::to_string(ray_axis);
    store_cells(file, meta, cells);
    const GridReader reader = stored_with_cache(file);
    for (const auto& [view, sky] :
         {std::pair<std::string, int>{"x", 2}, {"y", 2}, {"z", 2}, {"-x", 2}, {"-y", 2}, {"-z", 2}, {"-x", 1}, {"-y", 1}, {"z", 1}}) {
      const bool positive = view[0] != '-';
      const int axis = view.back() - 'x';
      const int up = axis != sky ? sky : axis == 2 ? 1 : 2, across = 3 - axis - up;
      const int64_t width = n[across], height = n[up];
      const Picture3D picture = picture_of(
          reader,
          {{"view", view}, {"up", sky == 2 ? "z" : "y"}, {"size", fmt::format("{},{}", width, height)}, {"flat", ""}, {"background", "#01020304"}},
          1 + ray_axis);
      for (int64_t y = 0; y < height; ++y)
        for (int64_t x = 0; x < width; ++x) {
          CAPTURE(ray_axis, view, x, y);
          Index3 c;
          const bool right_is_up_the_axis = (up == (axis + 1) % 3) == positive;  // forward x up
          c[across] = right_is_up_the_axis ? x : width - 1 - x;
          c[up] = height - 1 - y;
          Label first = 0;
          for (int64_t i = 0; i < n[axis] && first == 0; ++i) {
            c[axis] = positive ? i : n[axis] - 1 - i;
            first = cells[static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0])];
          }
          const Rgba expected = first == 0 ? Rgba{1, 2, 3, 4} : *parse_color(meta.materials[first].color);
          REQUIRE(pixel(picture, x, y) == expected);
        }
    }
  }
}

TEST_CASE("a picture is the same for any number of threads, cache and ray axis", "[render][threads]") {
  std::mt19937_64 random(1903);
  const TempFolder folder;
  const Grid grid = cube_grid(-1, 2, 24);
  const std::vector<Label> cells = random_cells(random, {24, 24, 24}, 3);
  std::optional<Picture3D> first;
  for (int ray_axis = 0; ray_axis < 3; ++ray_axis) {
    const auto file = folder / std::to_string(ray_axis);
    store_cells(file, with_tiny_chunks(metadata_of(grid, ray_axis, 3)), cells);
    for (const int threads : {1, 3})
      for (const size_t cache : {size_t{0}, size_t{1} << 24}) {
        const GridReader reader = stored_with_cache(file, cache);
        const Picture3D picture = picture_of(reader, {{"size", "90,70"}, {"cut", "x=1.5"}}, threads);
        if (!first) first = picture;
        REQUIRE(picture.rgba == first->rgba);
      }
  }
}

// A ball of radius 1 around the middle.
std::vector<Label> ball(int64_t n) {
  std::vector<Label> out;
  for (int64_t z = 0; z < n; ++z)
    for (int64_t y = 0; y < n; ++y)
      for (int64_t x = 0; x < n; ++x) {
        const auto off = [&](int64_t i) { return (2.0 * static_cast<double>(i) + 1 - static_cast<double>(n)) / static_cast<double>(n) * 1.25; };
        out.push_back(off(x) * off(x) + off(y) * off(y) + off(z) * off(z) < 1);
      }
  return out;
}

TEST_CASE("a ball is round: its outline is a circle, and light changes smoothly over it", "[render]") {
  const TempFolder folder;
  store_cells(folder / "ball", metadata_of(cube_grid(-1.25, 1.25, 128), 2, 2), ball(128));
  const GridReader reader = stored_with_cache(folder / "ball");
  const Picture3D picture = picture_of(reader, {{"view", "y"}, {"size", "200,200"}, {"background", "#00000000"}});
  double largest_step = 0;
  for (int64_t y = 0; y < 200; ++y)
    for (int64_t x = 0; x < 200; ++x) {
      CAPTURE(x, y);
      const double radius = std::hypot(static_cast<double>(x) - 99.5, static_cast<double>(y) - 99.5) / 80;
      if (radius < 0.97) REQUIRE(pixel(picture, x, y)[3] == 255);
      if (radius > 1.03) REQUIRE(pixel(picture, x, y)[3] == 0);
      if (radius < 0.9) largest_step = std::max(largest_step, std::abs(double{1} * pixel(picture, x, y)[1] - pixel(picture, x + 1, y)[1]));
    }
  CHECK(largest_step <= 24);
}

TEST_CASE("a picture is the same however few of its rows are held", "[render]") {
  const TempFolder folder;
  store_cells(folder / "ball", metadata_of(cube_grid(-1.25, 1.25, 48), 2, 2), ball(48));
  const GridReader reader = stored_with_cache(folder / "ball");
  for (const std::string size : {"200,210", "330,330"})
    for (const std::string view : {"y", "-z"})
      REQUIRE(picture_of(reader, {{"view", view}, {"size", size}}, 2, 1).rgba == picture_of(reader, {{"view", view}, {"size", size}}).rgba);
}

TEST_CASE("the default view has all of a box in it, from the same direction for any shape", "[render]") {
  for (const Box& box : {Box{{0, 0, 0}, {8, 8, 8}}, Box{{0, 0, 0}, {40, 3, 5}}, Box{{30, 2, 1}, {32, 4, 51}}}) {
    const Index3 n = {box.hi[0] + 5, box.hi[1], box.hi[2] + 90};
    const Grid grid{{Axis::uniform(7, 0.5, 0, n[0], 0.5), Axis::uniform(-70, 1, 0, n[1], 0.5), Axis::uniform(0, 1, 0, n[2], 0.5)}};
    const DefaultView view = default_view(grid, box);
    const Camera camera = perspective_camera(view.from, view.at, 2, 30, {90, 90});
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 p;
      for (int d = 0; d < 3; ++d) p[d] = grid.axis[d].plane(corner >> d & 1 ? box.hi[d] : box.lo[d]);
      const Vec3 off = p - camera.from;
      const double far = dot(off, camera.forward);
      CHECK(far > 0);
      CHECK(std::abs(dot(off, camera.up)) <= 45 * camera.pixel_at(far));
      CHECK(std::abs(dot(off, camera.right)) <= 45 * camera.pixel_at(far));
    }
    const Vec3 expected = normalised({-1, 1.4, -0.9});
    for (int d = 0; d < 3; ++d) CHECK(camera.forward[d] == Approx(expected[d]));
    CHECK(camera.up[2] > 0);
  }
}

TEST_CASE("a picture frames what is shown, or the whole grid where that is asked for", "[render]") {
  const TempFolder folder;
  constexpr int64_t n = 64;
  const Grid grid{{Axis::uniform(-1, 0.5, 0, n, 0.5), Axis::uniform(3, 0.25, 0, n, 0.5), Axis::uniform(0, 1, 0, n, 0.5)}};
  std::vector<Label> cells(n * n * n);
  const std::vector<Box> boxes = {{{5, 9, 3}, {11, 17, 8}}, {{50, 40, 60}, {52, 44, 61}}};  // of labels 1 and 2
  for (size_t i = 0; i < cells.size(); ++i) {
    const auto at = static_cast<int64_t>(i);
    const Index3 cell = {at % n, at / n % n, at / n / n};
    for (size_t b = 0; b < 2; ++b)
      if (overlap(boxes[b], {cell, {cell[0] + 1, cell[1] + 1, cell[2] + 1}})) cells[i] = static_cast<Label>(b + 1);
  }
  store_cells(folder / "g", with_tiny_chunks(metadata_of(grid, 1, 3)), cells);
  const GridReader reader = stored_with_cache(folder / "g");
  const auto view_of = [&](std::map<std::string, std::string, std::less<>> words) {
    const auto text = [&](std::string_view name) -> const std::string* {
      const auto it = words.find(name);
      return it == words.end() ? nullptr : &it->second;
    };
    return parse_render_options(text, reader, "--").aim.camera;
  };
  const auto frames = [&](const Camera& camera, const Box& box) {
    const DefaultView view = default_view(grid, box);
    return camera.from == view.from && camera.forward == normalised(view.at - view.from);
  };
  CHECK(frames(view_of({}), {{5, 9, 3}, {52, 44, 61}}));
  CHECK(frames(view_of({{"materials", "m1"}}), boxes[0]));
  CHECK(frames(view_of({{"labels", "2"}}), boxes[1]));
  CHECK(frames(view_of({{"labels", "2"}, {"level", "3"}}), {{48, 40, 56}, {56, 48, 64}}));
  CHECK(frames(view_of({{"labels", ""}}), grid.box(0)));
  CHECK(frames(view_of({{"labels", "2"}, {"domain", ""}}), grid.box(0)));
  CHECK(frames(view_of({{"labels", "2"}, {"domain", "0"}}), boxes[1]));
  CHECK(view_of({{"labels", "2"}, {"from", "0,0,0"}}).forward == normalised(default_view(grid, boxes[1]).at));
  CHECK(view_of({{"labels", "2"}, {"view", "x"}}).pixel == view_of({{"view", "x"}}).pixel);  // which the domain fills
  // However small it is, it fills some of the picture.
  const Picture3D picture = picture_of(reader, {{"labels", "2"}, {"size", "80,80"}, {"background", "#00000000"}});
  int64_t seen = 0;
  for (int64_t i = 0; i < 80 * 80; ++i) seen += pixel(picture, i % 80, i / 80)[3] == 255;
  CHECK(seen > 80 * 80 / 8);
}

TEST_CASE("a picture does not depend on the unit of length, however large or small", "[render]") {
  const TempFolder folder;
  std::optional<Picture3D> first;
  for (const int power : {0, -200, 200}) {  // of two, so that all coordinates are scaled exactly
    CAPTURE(power);
    const auto file = folder / std::to_string(power);
    store_cells(file, metadata_of(cube_grid_of(std::ldexp(-20, power), std::ldexp(1, power), 40), 2, 2), ball(40));
    const Picture3D picture = picture_of(stored_with_cache(file), {{"size", "100,80"}});
    if (!first) first = picture;
    size_t differ = 0;  // only the rounding of what is smooth
    for (size_t i = 0; i < picture.rgba.size(); ++i) differ += std::abs(picture.rgba[i] - first->rgba[i]) > 2;
    REQUIRE(differ == 0);
  }
}

TEST_CASE("pictures as files: PNG keeps every pixel, JPEG puts what is transparent on white", "[render]") {
  Picture3D picture{{3, 2}, {}};
  for (uint8_t i = 0; i < 24; ++i) picture.rgba.push_back(static_cast<uint8_t>(i * 10));
  const Png png = png_of(encode_picture(picture, "png"));
  REQUIRE(png.width == 3);
  for (size_t i = 0; i < 6; ++i)
    CHECK(png.pixels[i] == Rgba{picture.rgba[4 * i], picture.rgba[4 * i + 1], picture.rgba[4 * i + 2], picture.rgba[4 * i + 3]});
  CHECK(encode_picture(picture, "jpg").starts_with("\xff\xd8\xff"));
  CHECK(picture_format("a.b.jpeg") == "jpg");
  CHECK(picture_format("a.PNG") == "png");
  CHECK(picture_format("a.JPG") == "jpg");
  CHECK(picture_format("png").empty());
  CHECK(picture_format("a.jpg.gz").empty());
}

TEST_CASE("options that make no sense are usage errors that say what is expected", "[render]") {
  const TempFolder folder;
  store_cells(folder / "g", metadata_of(cube_grid(0, 1, 4), 0, 2), std::vector<Label>(64, 1));
  const GridReader reader = stored_with_cache(folder / "g");
  const std::vector<std::pair<std::map<std::string, std::string, std::less<>>, std::string>> wrong = {
      {{{"size", "0,5"}}, "--size: expected width and height from 1"},
      {{{"size", "16384,16384"}}, "at most"},
      {{{"size", "5"}}, "--size"},
      {{{"size", "5,5,5"}}, "--size"},
      {{{"size", "99999999999999999999,1"}}, "--size"},
      {{{"from", "1,2"}}, "--from: expected three numbers"},
      {{{"from", "1,2,nan"}}, "--from"},
      {{{"from", "1,2,1e308"}}, "--from: expected three numbers up to 1e75"},
      {{{"from", "1,2,3"}, {"at", "1,2,3"}}, "expected two points"},
      {{{"up", "w"}}, "--up: expected x, y or z"},
      {{{"fov", "180"}}, "--fov"},
      {{{"fov", "0"}}, "--fov"},
      {{{"view", "+x"}}, "--view"},
      {{{"view", ""}}, "--view"},
      {{{"view", "x"}, {"fov", "20"}}, "--view: expected alone, found with --fov"},
      {{{"level", "3"}}, "--level: expected 0 to 2, found '3'"},
      {{{"level", ""}}, "--level"},
      {{{"cut", "x=1,x=2"}}, "--cut"},
      {{{"cut", "x"}}, "--cut"},
      {{{"cut", "x=inf"}}, "--cut"},
      {{{"open", "1,2"}}, "--open: expected three numbers"},
      {{{"open-from", "1,2,3"}}, "--open-from: expected with --open"},
      {{{"plane", "1,2,3"}}, "--plane: expected four numbers"},
      {{{"plane", "0,0,0,1"}}, "the first three not all 0"},
      {{{"materials", "steel"}}, "found 'steel'"},
      {{{"bodies", "a"}}, "--bodies: expected names of bodies that this grid keeps apart"},
      {{{"labels", "2"}}, "--labels: expected numbers from 0 to 1"},
      {{{"labels", "1-0"}}, "--labels"},
      {{{"labels", "1,"}}, "--labels"},
      {{{"labels", "1"}, {"materials", "a"}}, "--materials: expected alone, found with --labels"},
      {{{"background", "white"}}, "--background: expected #rrggbb"},
      {{{"flat", "maybe"}}, "--flat"},
      {{{"domain", "2"}}, "--domain: expected 0 or 1"},
      {{{"domain", ""}, {"view", "x"}}, "--view: expected alone, found with --domain"},
      {{{"domain", ""}, {"from", "1,2,3"}, {"at", "0,0,0"}}, "--domain: expected without --from or without --at"},
  };
  for (const auto& [words, message] : wrong) {
    INFO(words.begin()->first << " " << words.begin()->second);
    REQUIRE_THROWS_AS(picture_of(reader, words), UsageError);
    REQUIRE_THROWS_WITH(picture_of(reader, words), Catch::Contains(message));
  }
}

TEST_CASE("an interrupted picture ends at once, and a damaged chunk is an error", "[render]") {
  const TempFolder folder;
  store_cells(folder / "ball", with_tiny_chunks(metadata_of(cube_grid(-1, 1, 24), 2, 2)), ball(24));
  {
    const Wanted by_nobody([] { throw Interrupted("enough"); }, Wanted::Asked::kByWorkers);
    REQUIRE_THROWS_AS(
        render(stored_with_cache(folder / "ball"), {.aim = {.camera = axis_camera(cube_grid(-1, 1, 24), 0, true, 2, {64, 64})}}, 2, [](double) {}),
        Interrupted);
  }
  Bytes bytes = file_bytes(folder / "ball");
  const GridReader sound = stored_with_cache(folder / "ball");
  const auto entry = sound.entry({0, 3, 3, 0});
  REQUIRE(entry->size > 0);
  bytes[entry->offset + entry->size / 2] ^= 1;
  const GridReader damaged = reader_of(bytes);
  REQUIRE_THROWS_AS(picture_of(damaged, {{"level", "0"}}, 2), FormatError);
}

}  // namespace
}  // namespace teracell::server
