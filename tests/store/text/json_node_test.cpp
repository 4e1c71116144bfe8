#include "store/text/json_node.hpp"

#include "store/base/error.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

const Json kDocument = parse_json(R"({"n": -0.0, "w": 7, "i": 1e3, "t": "a\tb", "l": [1, 2.5], "o": {"odd key": [true, null]}})", "");

// What reading the value says.
template <class F>
std::string refusal(const char* key, F&& read) {
  const JsonNode root(kDocument, "the text");
  try {
    read(root.require(key));
  } catch (const FormatError& e) {
    return e.what();
  }
  return "none";
}

TEST_CASE("What a value is not is said with its place, what was expected and what was found") {
  CHECK(refusal("x", [](const JsonNode&) {}) == "the text: the key \"x\" is missing");
  CHECK(refusal("w", [](const JsonNode& n) { n.any_text(); }) == "w: expected a string, found 7");
  CHECK(refusal("w", [](const JsonNode& n) { n.whole(6); }) == "w: expected a whole number from 0 to 6, found 7");
  CHECK(refusal("w", [](const JsonNode& n) { n.find("x"); }) == "w: expected an object, found 7");
  CHECK(refusal("i", [](const JsonNode& n) { n.whole(); }) == "i: expected a whole number, found 1000.0");
  CHECK(refusal("t", [](const JsonNode& n) { n.text(); }) == "t: expected a string without control characters, found \"a\\tb\"");
  CHECK(refusal("l", [](const JsonNode& n) { n.numbers<3>(); }) == "l: expected an array of 3, found an array of 2");
  CHECK(refusal("l", [](const JsonNode& n) { n.wholes<2>(); }) == "l[1]: expected a whole number from 0 to 9223372036854775807, found 2.5");
  CHECK(refusal("o", [](const JsonNode& n) {
          const JsonNode list = n.require("odd key");
          list.items()[1].boolean();
        }) == "o[\"odd key\"][1]: expected true or false, found null");
  CHECK(refusal("o", [](const JsonNode& n) {
          n.check_keys({"odd keys", "even"});
        }) == "o: unknown key \"odd key\": the nearest known one is \"odd keys\" (known here: odd keys, even)");
}

TEST_CASE("Numbers are read to the last bit, or with 0 for -0; integers may have an exponent") {
  const JsonNode root(kDocument, "the text");
  CHECK(std::signbit(root.require("n").exact()));
  CHECK_FALSE(std::signbit(root.require("n").number()));
  CHECK(root.require("i").integer(0, 1000) == 1000);
  CHECK(root.require("l").numbers<2>() == std::array{1.0, 2.5});
}

}  // namespace
}  // namespace teracell
