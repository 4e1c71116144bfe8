// Words and numbers of options, addresses and headers.
#include "store/text/words.hpp"

#include "tests/support/test.hpp"

namespace teracell {
namespace {

using Words = std::vector<std::string_view>;

TEST_CASE("A text has one part more than separators, and blanks around it are cut off") {
  REQUIRE(split("a,b,,c", ',') == Words{"a", "b", "", "c"});
  REQUIRE(split("", ',') == Words{""});
  REQUIRE(split(",", ',') == Words{"", ""});
  REQUIRE(trimmed(" \t a b\r\n") == "a b");
  REQUIRE(trimmed("  ").empty());
}

TEST_CASE("A number is all of its text, fits and is finite") {
  REQUIRE(number_in<int64_t>("-12") == -12);
  REQUIRE(number_in<double>("1e3") == 1000);
  for (const char* text : {"", " 1", "1 ", "+1", "1.5", "x", "9223372036854775808"}) REQUIRE_FALSE(number_in<int64_t>(text));
  REQUIRE_FALSE(number_in<uint64_t>("-1"));
  REQUIRE_FALSE(number_in<uint16_t>("65536"));
  for (const char* text : {"", "1e999", "inf", "nan", "1,2"}) REQUIRE_FALSE(number_in<double>(text));
}

TEST_CASE("A list has as many numbers as are asked for") {
  REQUIRE(numbers_in<int64_t>("1,-2,3", 3) == std::vector<int64_t>{1, -2, 3});
  REQUIRE(numbers_in<double>("0.5", 1) == std::vector<double>{0.5});
  for (const char* text : {"1,2", "1,2,3,4", "1,2,3,", ",1,2", "1,,3", "1, 2,3", ""}) REQUIRE_FALSE(numbers_in<int64_t>(text, 3));
}

}  // namespace
}  // namespace teracell
