#include "store/json_text.hpp"

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

#include "store/error.hpp"

namespace teracell {
namespace {

std::string nested(int levels) { return std::string(static_cast<size_t>(levels), '[') + std::string(static_cast<size_t>(levels), ']'); }

}  // namespace

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
  for (const char* text : {"", "[", "]", "[}", "{\"a\"}", "\"", "\"\\", "[1] 2"}) CHECK_THROWS_AS(parse_json(text, "text"), FormatError);
}

}  // namespace teracell
