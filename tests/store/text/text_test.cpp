// Parts of messages.
#include "store/text/text.hpp"

#include "tests/support/test.hpp"

namespace teracell {
namespace {

TEST_CASE("What is no UTF-8 in a text is replaced, the rest stays") {
  CHECK(utf8_of("plain \xc3\xbc \x01") == "plain \xc3\xbc \x01");
  CHECK(utf8_of("\xff\xfe!") == "\xef\xbf\xbd\xef\xbf\xbd!");
  CHECK(utf8_of("\xe2\x82|\xc3\xa4\xe2\x82") == "\xef\xbf\xbd|\xc3\xa4\xef\xbf\xbd");
  CHECK(utf8_of("") == "");
}

TEST_CASE("Printable text stays as it is, whatever its script") {
  for (const char* text : {"", "a name.stl", "µm, déck, 鋼, 🏟", "~ !"}) REQUIRE(printable(text) == text);
}

TEST_CASE("Control characters become question marks, those of two bytes too") {
  for (int c = 0; c < 0x20; ++c) REQUIRE(printable(std::string("a") + static_cast<char>(c) + "b") == "a?b");
  REQUIRE(printable("a\x7f") == "a?");
  REQUIRE(printable("\x1b[31mred") == "?[31mred");
  for (int c = 0x80; c < 0xA0; ++c) REQUIRE(printable(std::string("é\xC2") + static_cast<char>(c) + "b") == "é?b");
  REQUIRE(printable("\u00A0") == "\u00A0");  // the first character behind them
}

TEST_CASE("What is not UTF-8 becomes U+FFFD, and what is around it stays") {
  for (const char* bad : {"\xFF", "\xC2", "\xC0", "\x80"}) REQUIRE(printable(std::string("a") + bad + "b") == "a\uFFFDb");
  REQUIRE(printable("a\xC2") == "a\uFFFD");  // cut short at the end
}

TEST_CASE("A text is cut in the middle when it is too long for a message, between characters") {
  const std::string fits(kLongestMessage, 'x');
  REQUIRE(shortened(fits) == fits);
  REQUIRE(shortened("") == "");
  for (const std::string character : {"x", "é", "鋼", "🏟"})
    for (size_t before = 0; before < 4; ++before) {
      std::string text(before, 'b');
      while (text.size() <= 3 * kLongestMessage) text += character;
      const std::string cut = shortened(text + "e");
      CAPTURE(character, before);
      REQUIRE(cut.size() <= kLongestMessage);
      REQUIRE(cut.size() >= kLongestMessage - 8);
      REQUIRE(cut.starts_with(text.substr(0, 500)));
      REQUIRE(cut.ends_with("e"));
      REQUIRE(cut.find("[...]") != std::string::npos);
      REQUIRE(printable(cut) == cut);
    }
  REQUIRE(shortened(std::string(5000, '\x80')).size() <= kLongestMessage);  // what is no UTF-8
}

TEST_CASE("One thing has no plural; none and many have") {
  REQUIRE(plural(0, "chunk") == "0 chunks");
  REQUIRE(plural(1, "chunk") == "1 chunk");
  REQUIRE(plural(2, "stored level") == "2 stored levels");
  REQUIRE(plural(~uint64_t{0}, "cell") == "18446744073709551615 cells");
  REQUIRE(counted(1, "stretch", "stretches") == "1 stretch");
  REQUIRE(counted(1234, "stretch", "stretches") == "1,234 stretches");
  REQUIRE(counted(static_cast<unsigned __int128>(1) << 70, "cell") == "1,180,591,620,717,411,303,424 cells");
}

}  // namespace
}  // namespace teracell
