#include "store/text/json_text.hpp"

#include <fmt/format.h>
#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "store/base/error.hpp"

namespace teracell {
namespace {

std::string nested(int levels) { return std::string(static_cast<size_t>(levels), '[') + std::string(static_cast<size_t>(levels), ']'); }

}  // namespace

TEST_CASE("JSON is read as the library reads it") {
  for (const char* text : {"null", "[]", "{}", "-3", "7", "1.5e3", "\"a\\u00e4\\n\"", "[[], {}, [[1, -2], true, null, 2.5]]",
                           R"({"b": 1, "a": {"d": [{"x": [[]]}, {}], "c": "\"}]"}, "z": false})"})
    REQUIRE(parse_json(text, "text").dump() == nlohmann::ordered_json::parse(text).dump());
}

TEST_CASE("As many members and elements as there may be materials are read in linear time") {
  nlohmann::ordered_json::object_t members;
  nlohmann::ordered_json elements = nlohmann::ordered_json::array();
  for (int i = 0; i < 65536; ++i) {
    members.push_back({fmt::format("m{}", i), {{"color", "#102030"}}});
    elements.push_back({{"name", i}});
  }
  const std::string text = nlohmann::ordered_json{{"members", std::move(members)}, {"elements", elements}}.dump();
  REQUIRE(parse_json(text, "text").dump() == text);
}

TEST_CASE("JSON of 64 levels is read, of more is refused, however deep it is") {
  CHECK_NOTHROW(parse_json(nested(64), "text"));
  CHECK_THROWS_WITH(parse_json(nested(65), "g.tcell: report"), "g.tcell: report: expected JSON of at most 64 levels, found more");
  CHECK_THROWS_AS(parse_json(nested(10'000'000), "text"), FormatError);
}

TEST_CASE("Brackets in strings, behind escaped quotes too, are no levels") {
  const std::string text = R"({"a\"[[": ")" + std::string(1000, '[') + R"(\\", "b": "\\\"{{{"})";
  REQUIRE(parse_json(text, "text").size() == 2);
}

TEST_CASE("What is no JSON is an error that says where") {
  CHECK_THROWS_WITH(parse_json("{\"a\": nan}", "metadata"), "metadata: expected JSON, found something else at byte 8");
  for (const char* text : {"", "[", "]", "[}", "{} {}", "{\"a\": ", "{\"a\"}", "\"", "\"\\", "[1] 2"})
    CHECK_THROWS_AS(parse_json(text, "text"), FormatError);
}

TEST_CASE("JSON for others is ASCII on one line, and reads back, whatever bytes are in it") {
  const nlohmann::ordered_json j = {{"name", "\xc3\xbc\n\"\xff"}, {"cells", {1, 2}}};
  const std::string text = ascii_json(j);
  CHECK(text == R"({"name":"\u00fc\n\"\ufffd","cells":[1,2]})");
  CHECK(parse_json(text, "text")["name"] == "\xc3\xbc\n\"\xef\xbf\xbd");
}

TEST_CASE("What is no UTF-8 in a text is replaced, the rest stays") {
  CHECK(utf8_of("plain \xc3\xbc \x01") == "plain \xc3\xbc \x01");
  CHECK(utf8_of("\xff\xfe!") == "\xef\xbf\xbd\xef\xbf\xbd!");
  CHECK(utf8_of("") == "");
}

}  // namespace teracell
