#include "store/text/json_writer.hpp"

#include "store/text/json_text.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

using nlohmann::ordered_json;

template <class T>
std::string written(const T& what) {
  std::string text;
  JsonWriter(text).value(what);
  return text;
}

}  // namespace

TEST_CASE("JSON is written as the library writes it in ASCII") {
  for (const char* text : {"", "plain", "a \"quoted\" word", "back\\slash", "line\nand\ttab", "\x01\x1f\x7f", "Köln, 東京", "{[:,"})
    CHECK(written(text) == ascii_json(text));
  CHECK(written("\xff\xc3\xbc") == R"("\ufffd\u00fc")");
  for (const double number : {0.0, -0.0, 1.0, -7.0, 0.1, 1e14, 999999999999999.0, 1e15, 1e16, 123456789012345678.0, 1e-5, 5e-324,
                              1.7976931348623157e308, -1e300, std::numeric_limits<double>::infinity(), std::nan("")})
    CHECK(written(number) == ordered_json(number).dump());
  std::mt19937_64 random(7);
  for (int i = 0; i < 1000; ++i) {
    const double number = std::bit_cast<double>(random());
    CHECK(written(number) == ordered_json(number).dump());
    CHECK(written(std::trunc(number)) == ordered_json(std::trunc(number)).dump());
  }
  CHECK(written(uint64_t{18446744073709551615u}) == "18446744073709551615");
  CHECK(written(int64_t{-9223372036854775807}) == "-9223372036854775807");
  CHECK(written(std::array{1.0, 0.5, -2.0}) == "[1.0,0.5,-2.0]");
}

TEST_CASE("Commas stand between members and between elements, whatever these end with") {
  std::string text;
  JsonWriter out(text);
  out.begin_object()
      .field("a", "{")
      .field("b", nullptr)
      .key("c")
      .begin_array()
      .value("[")
      .value(",")
      .begin_object()
      .end_object()
      .begin_array()
      .end_array()
      .end_array();
  out.key("d").begin_object().field("e", ":").field("f", 1).end_object().key("g").raw("true").end_object();
  CHECK(text == R"({"a":"{","b":null,"c":["[",",",{},[]],"d":{"e":":","f":1},"g":true})");
  CHECK(ordered_json::parse(text).dump() == text);
}

TEST_CASE("A list ends before it takes more bytes than it may, and says how many items are left out") {
  const auto list = [](size_t count, size_t most) {
    std::string text = "{\"list\":";
    const size_t left_out = write_list(text, count, most, [](JsonWriter& out, size_t i) { out.begin_object().field("i", i).end_object(); });
    CHECK(text.starts_with("{\"list\":"));
    return std::pair(text.substr(8), left_out);
  };
  CHECK(list(0, 2) == std::pair(std::string("[]"), size_t{0}));
  const std::string whole = R"([{"i":0},{"i":1},{"i":2}])";
  CHECK(list(3, whole.size()) == std::pair(whole, size_t{0}));
  CHECK(list(3, whole.size() - 1) == std::pair(std::string(R"([{"i":0},{"i":1}])"), size_t{1}));
  CHECK(list(3, 2) == std::pair(std::string("[]"), size_t{3}));
}

}  // namespace teracell
