// Pictures in parts against the same pictures made at once.
#include "server/parts/picture_parts.hpp"

#include "server/picture/picture.hpp"
#include "tests/support/meshed.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

std::string made_at_once(const GridReader& reader, const SliceView& view, const PictureStyle& style) {
  std::string out;
  SetColors colors(reader.meta(), view.level, style.shown);
  PngWriter png(static_cast<uint32_t>(view.u1 - view.u0), static_cast<uint32_t>(view.v1 - view.v0), colors,
                [&](std::span<const uint8_t> bytes) { out.append(bytes.begin(), bytes.end()); });
  for_each_row(reader, view, colors.value(), true, 1, [&](int64_t, std::span<const uint16_t> row) { png.append(row); });
  png.finish();
  return out;
}

// Compares the pictures, and returns the number of parts.
int check_parts(const GridReader& reader, const SliceView& view, const PictureStyle& style = {}) {
  const auto parts = picture_parts(reader, view, style);
  std::string all;
  int n = 0;
  for (bool more = true; more; ++n) {
    std::string part;
    more = parts->append(part);
    REQUIRE(!part.empty());
    REQUIRE(part.size() < Parts::kEnough + (size_t{1} << 18));  // the encoder gives up to so much at once
    all += part;
  }
  REQUIRE(all == made_at_once(reader, view, style));
  return n;
}

struct Stored {
  TempFolder folder;
  std::optional<GridReader> reader;
  Stored(const Index3& n, int ray_axis, uint32_t labels) {
    std::vector<Label> cells(static_cast<size_t>(n[0] * n[1] * n[2]));
    std::mt19937_64 random(3);
    for (Label& c : cells) c = static_cast<Label>(random() % labels);
    Metadata meta = metadata_of(unit_grid(n), ray_axis, labels);
    for (uint32_t m = 0; m < labels; ++m) meta.materials[m].color = fmt::format("#{:02x}{:02x}00", 20 * m, 255 - 9 * m);
    store_cells(folder / "g.tcell", meta, cells);
    reader.emplace(folder / "g.tcell");
  }
};

TEST_CASE("The parts of a picture are those of the whole one, however the rays lie and whatever is shown of it", "[server][long]") {
  for (const int ray_axis : {0, 1, 2}) {
    if (kSanitized && ray_axis != 1) continue;
    const Stored s({700, 620, 3}, ray_axis, 5);
    CHECK(check_parts(*s.reader, whole_slice(s.reader->meta(), 2, 1, 0)) > 1);
    CHECK(check_parts(*s.reader, {2, 1, 0, 13, 250, 655, 517}) >= 1);
    CHECK(check_parts(*s.reader, whole_slice(s.reader->meta(), 2, 1, 0), {.shown = {true, false, true, false, true}}) > 1);
    CHECK(check_parts(*s.reader, whole_slice(s.reader->meta(), 2, 0, 1)) >= 1);
    CHECK(check_parts(*s.reader, whole_slice(s.reader->meta(), 0, 99, 0)) == 1);
  }
  if (kSanitized) return;  // as many cells again, of noise
  const Stored blends({700, 620, 3}, 2, 12);  // more sets than a palette has
  CHECK(check_parts(*blends.reader, whole_slice(blends.reader->meta(), 2, 0, 1)) > 1);
}

TEST_CASE("A row may be longer than a part", "[server]") {
  if (kSanitized) return;  // millions of cells of noise
  for (const int ray_axis : {0, 2}) {
    const Stored s({PngWriter::kLongest + 3'000, 1, 1}, ray_axis, 3);
    CHECK(check_parts(*s.reader, {2, 0, 0, 17, 0, PngWriter::kLongest + 2'999, 1}) > 5);
  }
}

TEST_CASE("Large pictures come in parts and have no outlines", "[server]") {
  const Stored s({8, 8, 8}, 2, 2);
  CHECK(picture_recipe(*s.reader, {2, 0, 0, 0, 0, 2048, 2048}).make);
  CHECK_FALSE(picture_recipe(*s.reader, {2, 0, 0, 0, 0, 2048, 2048}).parts);
  CHECK(picture_recipe(*s.reader, {2, 0, 0, 0, 0, 2048, 2049}).parts);
  CHECK_THROWS_WITH(picture_parts(*s.reader, whole_slice(s.reader->meta(), 2, 0, 0), {.outline = true}), Catch::StartsWith("outline: "));
}

}  // namespace
}  // namespace teracell::server
