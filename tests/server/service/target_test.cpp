// Addresses are split; every percent-encoding is decoded once, and everything else is refused.
#include "server/service/target.hpp"

#include "server/service/message.hpp"
#include "tests/support/test.hpp"

namespace teracell::server {
namespace {

using Segments = std::vector<std::string>;

TEST_CASE("A path is cut at its slashes and decoded after that", "[server]") {
  CHECK(parse_target("/").path == Segments{""});
  CHECK(parse_target("/a/b").path == Segments{"a", "b"});
  CHECK(parse_target("/a/").path == Segments{"a", ""});
  CHECK(parse_target("//a").path == Segments{"", "a"});
  CHECK(parse_target("/a%2Fb/%c3%A9%20").path == Segments{"a/b", "\xc3\xa9 "});
  CHECK(parse_target("/../%2e%2e/etc").path == Segments{"..", "..", "etc"});
  CHECK(parse_target("/a%252F").path == Segments{"a%2F"});
}

TEST_CASE("A query is cut at & and =, and decoded after that", "[server]") {
  const Target t = parse_target("/x?a=1&b&c=%26%3D&d=e=f");
  CHECK(t.path == Segments{"x"});
  CHECK(*t.find("a") == "1");
  CHECK(*t.find("b") == "");
  CHECK(*t.find("c") == "&=");
  CHECK(*t.find("d") == "e=f");
  CHECK(t.find("e") == nullptr);
  CHECK(parse_target("/x?").query.empty());
  CHECK_NOTHROW(t.allow({"a", "b", "c", "d"}));
  CHECK_THROWS_WITH(t.allow({"a", "b", "c"}), "there is no parameter 'd'; expected one of a, b, c");
  CHECK_THROWS_WITH(parse_target("/x?a=1&a=2").find("a"), "a: expected once, found twice");
}

TEST_CASE("Broken encodings and control characters are refused", "[server]") {
  for (const char* bad : {"", "x", "*", "http://host/", "/%", "/%4", "/%4g", "/%g4", "/a%00b", "/%0a", "/%7f", "/?a=%", "/?%0d=1"}) {
    INFO(bad);
    CHECK_THROWS_AS(parse_target(bad), HttpError);
  }
  CHECK_THROWS_AS(parse_target(std::string_view("/a\0b", 4)), HttpError);
  CHECK_THROWS_AS(parse_target("/a\tb"), HttpError);
}

TEST_CASE("Numbers: the message names the parameter, the range and what was found", "[server]") {
  CHECK(integer_in("0", "level", 0, 9) == 0);
  CHECK(integer_in("9", "level", 0, 9) == 9);
  CHECK_THROWS_WITH(integer_in("10", "level", 0, 9), "level: expected a whole number from 0 to 9, found '10'");
  for (const char* bad : {"", "-1", "+1", "1.5", "1e3", " 1", "1 ", "0x1", "99999999999999999999", "nan"}) {
    INFO(bad);
    CHECK_THROWS_AS(integer_in(bad, "n", 0, 9), HttpError);
    CHECK_FALSE(plain_integer(bad));
  }
  CHECK(integers("1,-2,3", 3, "region") == std::vector<int64_t>{1, -2, 3});
  for (const char* bad : {"", "1,2", "1,2,3,4", "1,,3", "1,2,", "a,b,c"})
    CHECK_THROWS_WITH(integers(bad, 3, "region"), Catch::StartsWith("region: expected 3 whole numbers"));
  CHECK(plain_integer("0") == 0);
  CHECK(plain_integer("120") == 120);
  CHECK_FALSE(plain_integer("012"));
}

TEST_CASE("Whatever the bytes, a target is parsed or refused", "[server]") {
  std::mt19937 random(1);
  const std::string letters = "/?&=%0123456789abcdefAF.\\\n\x7f ";
  for (int i = 0; i < 20000; ++i) {
    std::string text = i % 4 ? "/" : "";
    for (auto n = random() % 24; n > 0; --n) text += letters[random() % letters.size()];
    try {
      parse_target(text);
    } catch (const HttpError& e) {
      CHECK(e.status == 400);
    }
  }
}

}  // namespace
}  // namespace teracell::server
