// Pictures in three dimensions, as numbers and at single points, over HTTP.
#include "tests/server/served.hpp"
#include "tests/support/png.hpp"

namespace teracell::server {
namespace {

using namespace testing;

const std::string kBase = "/api/v1/grids/g/view.";

uint32_t u32(const std::string& bytes, size_t at) {
  uint32_t out = 0;
  for (size_t i = 0; i < 4; ++i) out |= uint32_t{static_cast<uint8_t>(bytes.at(at + i))} << (8 * i);
  return out;
}

TEST_CASE("The numbers of a view along an axis are the first cells of its columns, and so is what is seen at their middles", "[server]") {
  for (const int ray_axis : {0, 1, 2}) {
    Served s(ray_axis);
    const std::string view = fmt::format("view=z&size={},{}&level=0&labels=1-4", kCells[0], kCells[1]);
    const Response r = s.get(kBase + "bin?" + view);
    REQUIRE(r.status == 200);
    REQUIRE(r.content_type == "application/octet-stream");
    const std::string& bytes = *r.body;
    REQUIRE(bytes.substr(0, 4) == "TCS1");
    REQUIRE(u32(bytes, 4) == kCells[0]);
    REQUIRE(u32(bytes, 8) == kCells[1]);
    for (int64_t row = 0; row < kCells[1]; row += 97)
      for (int64_t column = 0; column < kCells[0]; column += 5) {
        CAPTURE(ray_axis, row, column);
        const auto code = static_cast<uint8_t>(bytes.at(static_cast<size_t>(40 + row * kCells[0] + column)));
        const json seen = s.parsed(fmt::format("{}json?{}&pixel={}.5,{}.5", kBase, view, column, row))["seen"];
        REQUIRE(seen.is_null() == (code == 0));
        if (seen.is_null()) continue;
        REQUIRE(seen["label"] == code - 1);
        REQUIRE(seen["level"] == 0);
        REQUIRE(seen["body"].is_null());
        const Index3 cell = seen["cell"];
        REQUIRE(s.at(cell[0], cell[1], cell[2]) == static_cast<Label>(code - 1));
        for (int64_t before = 0; before < cell[2]; ++before) REQUIRE(s.at(cell[0], cell[1], before) == 0);
      }
  }
}

TEST_CASE("Windows have their own size; wrong ones, wrong options and too many pixels are refused in words", "[server]") {
  Served s;
  const Response r = s.get(kBase + "bin?size=60,40&window=10,5,30,25&quick=1");
  REQUIRE(r.status == 200);
  CHECK(u32(*r.body, 4) == 20);
  CHECK(u32(*r.body, 8) == 20);
  CHECK(u32(*r.body, 12) == 0);
  CHECK(s.error(kBase + "bin?size=60,40&window=10,5,61,25").starts_with("window: expected X0,Y0,X1,Y1, a part of 0,0,60,40"));
  CHECK(s.error(kBase + "bin?size=60,40&window=10,5,10,25").starts_with("window"));
  CHECK(s.error(kBase + "bin?size=60,40&window=1,2,3").starts_with("window"));
  const std::string huge = "99999999999999999999";  // more than any number that is counted in
  CHECK(s.error(kBase + "bin?labels=" + huge).starts_with("labels: expected numbers from 0 to"));
  CHECK(s.error(kBase + "bin?level=" + huge).starts_with("level: expected 0 to"));
  CHECK(s.error(kBase + "bin?size=" + huge + ",9").starts_with("size: expected width and height"));
  CHECK(s.error(kBase + "bin?size=16384,4096") == "window: expected at most 8388608 pixels, found 16384 x 4096");
  CHECK(s.error(kBase + "bin?size=60,40&quick=2").starts_with("quick"));
  CHECK(s.error(kBase + "png?size=60,40&window=0,0,1,1").find("window") != std::string::npos);
  CHECK(s.error(kBase + "json").starts_with("pixel: expected two numbers"));
  for (const char* wrong : {"", "1", "1,", ",1", "1,2,3", "a,b", "1e300,1", "nan,1"})
    CHECK(s.error(kBase + "json?pixel=" + wrong).starts_with("pixel: expected two numbers"));
  CHECK(s.parsed(kBase + "json?size=60,40&pixel=-500,-500")["seen"].is_null());
  CHECK(s.get(kBase + "gif").status == 404);
  CHECK(s.get(kBase + "png/1").status == 404);
}

TEST_CASE("A picture frames what is shown, and with domain=1 the whole grid", "[server]") {
  TempFolder folder;
  std::vector<Label> cells(static_cast<size_t>(kCells[0] * kCells[1] * kCells[2]));
  cells[5 + 7 * 37] = cells[6 + 8 * 37] = 1;  // two small cells at the bottom
  store_cells(folder / "g.tcell", metadata_of(grid(), 2, kMaterials), cells);
  Service service({.named = {folder.path()}});
  const auto shown = [&](const std::string& more) {
    const Response r = handle(service, {.target = kBase + "png?size=64,48&flat=1&background=%2300000000" + more});
    REQUIRE(r.status == 200);
    int64_t out = 0;
    for (const auto& pixel : png_of(*r.body).pixels) out += pixel[3] != 0;
    return out;
  };
  CHECK(shown("") > 64 * 48 / 20);
  CHECK(shown("&domain=0") == shown(""));
  CHECK(shown("&domain=1") <= 2);
}

TEST_CASE("A picture is made from the numbers of the same view: what is background in one is so in the other", "[server]") {
  Served s;
  const std::string view = "size=64,48&labels=2&open=8,60,10";
  const Png picture = png_of(*s.get(kBase + "png?" + view + "&flat=1&background=%2300000000").body);
  const std::string bytes = *s.get(kBase + "bin?" + view).body;
  size_t shown = 0;
  for (size_t i = 0; i < picture.pixels.size(); ++i) {
    REQUIRE((picture.pixels[i][3] != 0) == (bytes.at(40 + i) != 0));
    shown += bytes.at(40 + i) != 0;
  }
  CHECK(shown > 50);
  // The corner that is cut away is the one that another eye sees.
  CHECK(*s.get(kBase + "bin?" + view + "&open-from=1e3,-1e3,1e3").body == bytes);
  CHECK(*s.get(kBase + "bin?" + view + "&open-from=-1e3,-1e3,1e3").body != bytes);
}

}  // namespace
}  // namespace teracell::server
