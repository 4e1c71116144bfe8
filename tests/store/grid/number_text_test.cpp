#include "store/grid/number_text.hpp"

#include "tests/support/test.hpp"

namespace teracell {

TEST_CASE("Numbers are written as people write them: whole digits, or powers of ten without an e") {
  CHECK(number_text(0, 4) == "0");
  CHECK(number_text(0.04187, 3) == "0.0419");
  CHECK(number_text(1234.6, 3) == "1235");
  CHECK(number_text(-2.5, 3) == "-2.5");
  CHECK(number_text(999'999'999, 4) == "1 × 10⁹");
  CHECK(number_text(4.32e9, 4) == "4.32 × 10⁹");
  CHECK(number_text(2.734e-16, 3) == "2.73 × 10⁻¹⁶");
  CHECK(place_text({4, -0.0, -0.25}) == "(4, 0, -0.25)");
}

}  // namespace teracell
