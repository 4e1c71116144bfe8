#include "store/text/color.hpp"

#include "tests/support/test.hpp"

namespace teracell {
namespace {

TEST_CASE("a colour is #rrggbb or #rrggbbaa") {
  REQUIRE(parse_color("#8899aA") == Rgba{0x88, 0x99, 0xaa, 255});
  REQUIRE(parse_color("#01020300") == Rgba{1, 2, 3, 0});
  for (const char* bad : {"", "#", "8899aa", "#8899a", "#8899aag", "#8899aa0", "#8899aa001", "red", "#+1+1+1", "# 10101"}) REQUIRE(!parse_color(bad));
}

}  // namespace
}  // namespace teracell
