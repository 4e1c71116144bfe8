#include "store/text/json_text.hpp"

#include "store/base/error.hpp"
#include "tests/support/test.hpp"

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
  CHECK_THROWS_WITH(parse_json("{\"a\": nan}", "metadata"), Catch::StartsWith("metadata: line 1, column 8: syntax error"));
  for (const char* text : {"", "[", "]", "[}", "{} {}", "{\"a\": ", "{\"a\"}", "\"", "\"\\", "[1] 2"})
    CHECK_THROWS_AS(parse_json(text, "text"), FormatError);
}

TEST_CASE("JSON for others is ASCII on one line, and reads back, whatever bytes are in it") {
  const nlohmann::ordered_json j = {{"name", "\xc3\xbc\n\"\xff"}, {"cells", {1, 2}}};
  const std::string text = ascii_json(j);
  CHECK(text == R"({"name":"\u00fc\n\"\ufffd","cells":[1,2]})");
  CHECK(parse_json(text, "text")["name"] == "\xc3\xbc\n\"\xef\xbf\xbd");
}

TEST_CASE("A key that is given twice is refused with its place") {
  CHECK_THROWS_WITH(parse_json(R"({"a": [1, {"b c": {"d": 1, "d": 2}}]})", "g"), "g: a[1][\"b c\"].d: this key is given twice: keep one of them");
  CHECK_THROWS_WITH(parse_json(R"({"d": 1, "d": 2})", ""), "d: this key is given twice: keep one of them");
}

TEST_CASE("A document read part by part hands out the elements of its lists, keeps the rest, and of one object takes only the lists") {
  std::string parts;
  const JsonParts taking{[&](const std::string& list, size_t i, const Json& element) { parts += fmt::format("{}[{}]={} ", list, i, element.dump()); },
                         "s"};
  const std::string text =
      R"({"a": [1, {"b": [2, {"s": 3}]}, []], "s": {"x": 4, "y": {"a": [5]}, "a": [{"b": 9}, 2], "x": 1}, "c": {"d": [6]}, "e": [], "f": [7], "g": 8})";
  CHECK(parse_json(text, "text", 7 + 3, taking).dump() == R"({"a":[],"s":{"a":[]},"c":{"d":[6]},"e":[],"f":[],"g":8})");
  CHECK(parts == R"(a[0]=1 a[1]={"b":[2,{"s":3}]} a[2]=[] s.a[0]={"b":9} s.a[1]=2 f[0]=7 )");
  CHECK_THROWS_WITH(parse_json(R"({"a": [1, 2, {"b": 1, "b": 2}]})", "", 8, taking), Catch::StartsWith("a[2].b: "));
  CHECK_THROWS_WITH(parse_json(R"({"s": {"c": 1, "a": [1, {"b": 1, "b": 2}]}})", "", 8, taking), Catch::StartsWith("s.a[1].b: "));
  CHECK_THROWS_WITH(parse_json(R"({"a": [[1, 2, 3]]})", "", 4, taking), Catch::Contains("at most 4 values"));
  CHECK_THROWS_WITH(parse_json(R"({"s": {"c": {"d": )" + nested(62) + "}}}", "", 4, taking), Catch::Contains("at most 64 levels"));
  for (const char* other : {"[[1], [2]]", "3", R"("s")"}) CHECK(parse_json(other, "", 5, taking).dump() == Json::parse(other).dump());
}

}  // namespace teracell
