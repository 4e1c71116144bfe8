// Deep Zoom: every pixel of every tile of every level.
#include "tests/support/pixels.hpp"

namespace teracell::server {

using namespace testing;
namespace {

void check_slice(ServedCells& served, int axis, int64_t index) {
  const Index3 n = served.meta().grid.cells();
  const RayFrame f = RayFrame::along(axis);
  const std::string address = fmt::format("/dzi/g/{}/{}", axis_name(axis), index);
  const Response description = served.get(address + ".dzi");
  REQUIRE(description.status == 200);
  REQUIRE(description.content_type == "application/xml");
  REQUIRE_THAT(*description.body,
               Catch::Contains(R"(Format="png" Overlap="0" TileSize="512")") &&
                   Catch::Contains(fmt::format(R"(<Size Width="{}" Height="{}"/>)", n[static_cast<size_t>(f.u)], n[static_cast<size_t>(f.v)])));
  int last = 0;
  while ((int64_t{1} << last) < std::max(n[static_cast<size_t>(f.u)], n[static_cast<size_t>(f.v)])) ++last;
  for (int level = 0; level <= last; ++level) {
    const Png whole = expected_picture(served, axis, index, last - level);
    int64_t columns = 0, rows = 0;
    for (; columns * 512 < whole.width; ++columns)
      for (rows = 0; rows * 512 < whole.height; ++rows) {
        const Response r = served.get(fmt::format("{}_files/{}/{}_{}.png", address, level, columns, rows));
        REQUIRE(r.status == 200);
        REQUIRE(r.content_type == "image/png");
        const Png tile = png_of(*r.body);
        REQUIRE(tile.width == std::min<int64_t>(512, whole.width - columns * 512));
        REQUIRE(tile.height == std::min<int64_t>(512, whole.height - rows * 512));
        REQUIRE(shows(tile, whole, columns * 512, rows * 512));
      }
    require_missing(served.get(fmt::format("{}_files/{}/{}_0.png", address, level, columns)));
    require_missing(served.get(fmt::format("{}_files/{}/0_{}.png", address, level, rows)));
  }
  require_missing(served.get(fmt::format("{}_files/{}/0_0.png", address, last + 1)));
}

TEST_CASE("Deep Zoom: every pixel of every level across every axis, from the top", "[server][long]") {
  ServedCells served(odd_grid(), 1, 6);
  for (int axis = 0; axis < 3; ++axis)
    for (const int64_t index : {int64_t{0}, int64_t{33}, served.meta().grid.cells()[static_cast<size_t>(axis)] - 1}) check_slice(served, axis, index);
}

TEST_CASE("Deep Zoom: several tiles on a side", "[server]") {
  ServedCells served(long_grid(), 0, 5);
  check_slice(served, 1, 2);
}

TEST_CASE("Deep Zoom: a slice across the longest axis has fewer levels than the grid, one along it no more", "[server]") {
  for (const Index3& n : {Index3{1, 1, 1}, Index3{1, 1, 9}, Index3{2, 1, 1}, Index3{5, 4, 1}, Index3{64, 64, 64}, Index3{65, 2, 3}}) {
    ServedCells served(unit_grid(n), 2, 3);
    for (int a = 0; a < 3; ++a) check_slice(served, a, n[static_cast<size_t>(a)] - 1);
  }
}

TEST_CASE("Deep Zoom: what is not there is a 404 without a body", "[server]") {
  ServedCells served(odd_grid(), 1, 6);
  require_missing(served, {"/dzi",
                           "/dzi/g",
                           "/dzi/other/z/0.dzi",
                           "/dzi/g/w/0.dzi",
                           "/dzi/g/z/67.dzi",
                           "/dzi/g/z/-1.dzi",
                           "/dzi/g/z/00.dzi",
                           "/dzi/g/z/0",
                           "/dzi/g/z/.dzi",
                           "/dzi/g/z/0_files",
                           "/dzi/g/z/0_files/8",
                           "/dzi/g/z/0_files/8/0_0",
                           "/dzi/g/z/0_files/8/0_0.jpg",
                           "/dzi/g/z/0_files/08/0_0.png",
                           "/dzi/g/z/0_files/8/0.png",
                           "/dzi/g/z/0_files/8/.png",
                           "/dzi/g/z/67_files/8/0_0.png",
                           "/dzi/g/z/0_files/8/0_0_0.png",
                           "/dzi/g/z/0_files/8/0_-1.png",
                           "/dzi/g/z/0.dzi/8/0_0.png"});
}

}  // namespace
}  // namespace teracell::server
