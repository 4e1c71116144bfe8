// JSON that is passed on unparsed: what is let through is what a parser of JSON takes, and what the format says of it.
#include "store/text/json_check.hpp"

#include "store/base/error.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

bool passes(const std::string& text) {
  try {
    check_json(text, "text");
    return true;
  } catch (const FormatError&) {
    return false;
  }
}

// The same decision by the library's parser, with a set of keys for each object.
struct Oracle : nlohmann::json_sax<nlohmann::json> {
  std::vector<std::set<std::string>> open;
  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t) override { return true; }
  bool number_unsigned(number_unsigned_t) override { return true; }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool string(string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool start_object(size_t) override { return start_array(0); }
  bool start_array(size_t) override {
    open.emplace_back();
    return open.size() <= 64;
  }
  bool end_object() override { return end_array(); }
  bool end_array() override {
    open.pop_back();
    return true;
  }
  bool key(string_t& key) override { return open.back().insert(key).second; }
  bool parse_error(size_t, const std::string&, const nlohmann::json::exception&) override { return false; }
};

bool expected_to_pass(const std::string& text) {
  for (const char c : text)
    if (static_cast<unsigned char>(c) >= 0x7f) return false;
  Oracle oracle;
  return nlohmann::json::sax_parse(text, &oracle);
}

std::string nested(size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); }

TEST_CASE("What passes is the JSON that a parser takes, in ASCII, with keys that differ") {
  const std::string sample = R"( {"a": [1, -2.5e+3, 0.125, {}, []], "b\u00fc\ud83d\ude00": {"a": "x\"\\\/\b\f\n\r\t", "\u0061b": true},)"
                             R"( "c": [false, null, {"a": {"a": 1E-7, "b": 0}}], "": "" } )";
  REQUIRE(passes(sample));
  const std::string letters = "{}[],:\"\\/ \n\x01\x7f\x80\xc3u0019aAbcdDeE.+-tfn";
  std::mt19937_64 random(3);
  size_t sound = 0;
  for (size_t i = 0; i < rounds(100'000); ++i) {
    std::string text = sample;
    for (auto edits = random() % 3; edits <= 2; ++edits) {
      const size_t at = random() % text.size();
      const char c = letters[random() % letters.size()];
      switch (random() % 3) {
        case 0: text[at] = c; break;
        case 1: text.insert(at, 1, c); break;
        default: text.erase(at, 1 + random() % 3);
      }
    }
    const bool expected = expected_to_pass(text);
    sound += expected;
    if (passes(text) != expected) FAIL(text << " passes: " << !expected);
  }
  REQUIRE(sound > rounds(100'000) / 20);
}

TEST_CASE("A text cut short anywhere is refused") {
  const std::string text = R"({"a":[1.5,{"b":"\ud83d\ude00"}],"c":true})";
  for (size_t n = 0; n < text.size(); ++n) REQUIRE_FALSE(passes(text.substr(0, n)));
}

TEST_CASE("A key that occurs twice in an object is refused, however it is written; in different objects it may") {
  CHECK_THROWS_WITH(check_json(R"({"a":1,"b":2,"a":3})", "g.tcell: report"), Catch::StartsWith("g.tcell: report: byte ") && Catch::Contains("twice"));
  CHECK_FALSE(passes(R"({"a":1,"\u0061":2})"));
  CHECK_FALSE(passes(R"({"/":1,"\/":2})"));
  CHECK_FALSE(passes(R"([{"x":{"\n":[],"b":{"\n":1},"\u000a":0}}])"));
  CHECK(passes(R"([{"a":{"a":[{"a":1},{"a":2}]},"b":{"a":1}},{"a":1}])"));
}

TEST_CASE("Depth, keys of an object and the size of numbers are bounded") {
  CHECK(passes(nested(64)));
  CHECK_THROWS_WITH(check_json(nested(65), "report"), Catch::Contains("at most 64 levels"));
  CHECK_FALSE(passes(nested(10'000'000)));
  const auto with_keys = [](size_t count) {
    std::string text = "{";
    for (size_t i = 0; i < count; ++i) text += fmt::format("{}\"{}\":0", i == 0 ? "" : ",", i);
    return text + "}";
  };
  CHECK(passes(with_keys(kMostJsonKeys)));
  CHECK_THROWS_WITH(check_json(with_keys(kMostJsonKeys + 1), "report"), Catch::Contains("at most 65536 keys"));
  CHECK(passes("[340282366920938463463374607431768211455, 1e308, 1e-999, -0, 0.0]"));
  CHECK_FALSE(passes("1e309"));
  CHECK_FALSE(passes("-" + std::string(310, '9')));
  CHECK_FALSE(passes(std::string(1 << 20, '1')));
}

}  // namespace
}  // namespace teracell
