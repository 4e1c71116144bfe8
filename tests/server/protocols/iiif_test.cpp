// IIIF, level 0: all that info.json offers exists, with the right pixels, and nothing else does.
#include "tests/support/pixels.hpp"

namespace teracell::server {

using namespace testing;
namespace {

using nlohmann::ordered_json;

// Asks for everything that info.json implies, as its clients do.
void check_slice(ServedCells& served, const std::string& id, int axis, int64_t index) {
  const std::string address = fmt::format("/iiif/{}-{}-{}", id, axis_name(axis), index);
  const ordered_json info = served.json(address + "/info.json");
  REQUIRE(info["id"] == "http://host:8080" + address);
  REQUIRE(info["@context"] == "http://iiif.io/api/image/3/context.json");
  REQUIRE(info["type"] == "ImageService3");
  REQUIRE(info["profile"] == "level0");
  const int64_t width = info["width"], height = info["height"], size = info["tiles"][0]["width"];
  REQUIRE(info["tiles"][0]["height"] == size);
  const auto picture = [&](const std::string& region, const std::string& asked) {
    const Response r = served.get(fmt::format("{}/{}/{}/0/default.png", address, region, asked));
    INFO(region << "/" << asked);
    REQUIRE(r.status == 200);
    REQUIRE(r.content_type == "image/png");
    return png_of(*r.body);
  };
  int scale = 0;
  for (const int64_t factor : info["tiles"][0]["scaleFactors"]) {
    REQUIRE(factor == int64_t{1} << scale);
    const Png whole = expected_picture(served, axis, index, scale);
    REQUIRE(whole.width == (width + factor - 1) / factor);
    for (int64_t y = 0; y < height; y += size * factor)
      for (int64_t x = 0; x < width; x += size * factor) {
        const int64_t w = std::min(size * factor, width - x), h = std::min(size * factor, height - y);
        const int64_t sw = (w + factor - 1) / factor, sh = (h + factor - 1) / factor;
        for (const std::string& asked : {fmt::format("{},{}", sw, sh), fmt::format("{},", sw), fmt::format(",{}", sh)}) {
          const Png tile = picture(fmt::format("{},{},{},{}", x, y, w, h), asked);
          REQUIRE((tile.width == sw && tile.height == sh));
          REQUIRE(shows(tile, whole, x / factor, y / factor));
        }
      }
    ++scale;
  }
  // At the last factor the picture is one tile.
  REQUIRE(expected_picture(served, axis, index, scale - 1).width <= size);
  REQUIRE(expected_picture(served, axis, index, scale - 1).height <= size);
  int64_t last = 0;
  for (const auto& s : info["sizes"]) {
    const int64_t w = s["width"], h = s["height"];
    REQUIRE(w * h > last);
    REQUIRE(w * h <= info["maxArea"].get<int64_t>());
    last = w * h;
    int at = 0;
    while (ceil_shift(width, at) != w || ceil_shift(height, at) != h) ++at;
    const Png found = picture("full", fmt::format("{},{}", w, h));
    REQUIRE(found.width == w);
    REQUIRE(shows(found, expected_picture(served, axis, index, at), 0, 0));
  }
}

TEST_CASE("IIIF: every tile and every size that info.json offers, pixel by pixel", "[server][long]") {
  ServedCells served(odd_grid(), 1, 6);
  for (int axis = 0; axis < 3; ++axis) check_slice(served, "g", axis, 41);
  const Png full = png_of(*served.get("/iiif/g-x-41/full/max/0/default.png").body);
  REQUIRE((full.width == 130 && full.height == 67));
  REQUIRE(shows(full, expected_picture(served, 0, 41, 0), 0, 0));
}

TEST_CASE("IIIF: several tiles; the whole picture is there at scales within the limit of pixels", "[server][long]") {
  ServedCells served(long_grid(), 0, 5, 0, "a-y-1");  // an id that looks like another slice's name
  check_slice(served, "a-y-1", 1, 2);
  const Response whole = served.get("/iiif/a-y-1-y-2/full/max/0/default.png");
  REQUIRE(whole.status == 400);
  REQUIRE_THAT(*whole.body, Catch::Contains("524288"));
  REQUIRE(served.json("/iiif/a-y-1-y-2/info.json")["sizes"].size() == 2);
  REQUIRE(served.get("/iiif/a-y-1-y-2/0,0,512,512/max/0/default.png").status == 200);
}

TEST_CASE("IIIF: the address of a slice leads to its info.json, whose id is absolute, behind a proxy as well", "[server]") {
  ServedCells served(odd_grid(), 1, 6, 0, "\xC3\xA4 b");
  server::Request request{.target = "/iiif/%C3%A4%20b-z-3", .origin = "https://example.org", .prefix = "/grids"};
  const Response r = served.get(request);
  REQUIRE(r.status == 303);
  REQUIRE(r.location == "https://example.org/grids/iiif/%C3%A4%20b-z-3/info.json");
  request.target += "/info.json";
  REQUIRE(ordered_json::parse(*served.get(request).body)["id"] == "https://example.org/grids/iiif/%C3%A4%20b-z-3");
  request.origin = "http://other";
  REQUIRE(ordered_json::parse(*served.get(request).body)["id"] == "http://other/grids/iiif/%C3%A4%20b-z-3");
}

TEST_CASE("IIIF: what is not offered is a 404 without a body", "[server]") {
  ServedCells served(odd_grid(), 1, 6);
  require_missing(served, {"/iiif",
                           "/iiif/g",
                           "/iiif/g-z",
                           "/iiif/-z-0",
                           "/iiif/g-z-67",
                           "/iiif/g-w-0",
                           "/iiif/other-z-0",
                           "/iiif/other-z-0/info.json",
                           "/iiif/g-z-67/info.json",
                           "/iiif/g-z-0/",
                           "/iiif/g-z-0/full/max/0/default.jpg",
                           "/iiif/g-z-0/full/max/90/default.png",
                           "/iiif/g-z-0/full/max/0/gray.png",
                           "/iiif/g-z-0/full/71,131/0/default.png",
                           "/iiif/g-z-0/full/%5Emax/0/default.png",
                           "/iiif/g-z-0/full/pct:50/0/default.png",
                           "/iiif/g-z-0/square/max/0/default.png",
                           "/iiif/g-z-0/0,0,10,10/10,10/0/default.png",
                           "/iiif/g-z-0/0,0,70/max/0/default.png",
                           "/iiif/g-z-0/0,0,0,0/max/0/default.png",
                           "/iiif/g-z-0/512,0,1,1/1,1/0/default.png",
                           "/iiif/g-z-0/full//0/default.png",
                           "/iiif/g-z-0/full/,/0/default.png",
                           "/iiif/g-z-0/0,0,999999999999999999,999999999999999999/1,1/0/default.png"});
}

}  // namespace
}  // namespace teracell::server
