// Token files: what may be a token, and what the messages say of the rest.
#include "server/http/token.hpp"

#include <fstream>

#include <catch2/catch.hpp>

#include "store/error.hpp"
#include "tests/support/meshed.hpp"

namespace teracell {
namespace {

using namespace testing;

struct TokenFile {
  TempFolder folder;
  std::filesystem::path path = folder / "token";
  explicit TokenFile(const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
};

TEST_CASE("The token is the first line, without white space at its end", "[server]") {
  for (const char* text : {"secret", "secret\n", "secret \t\r\n", "secret\nnot this one\n"}) {
    INFO(text);
    CHECK(read_token(TokenFile(text).path) == "secret");
  }
  CHECK(read_token(TokenFile("!~").path) == "!~");
  CHECK(read_token(TokenFile(std::string(4096, 'x')).path).size() == 4096);
}

TEST_CASE("A line that no header field can carry is refused", "[server]") {
  for (const char* text : {"", "\n", " \t\nsecret", " secret", "two words", "caf\xc3\xa9", "a\x7f", "a\x01"}) {
    INFO(text);
    CHECK_THROWS_AS(read_token(TokenFile(text).path), UsageError);
  }
  const TokenFile empty("\n"), long_one(std::string(4097, 'x'));
  CHECK_THROWS_WITH(read_token(empty.path),
                    Catch::StartsWith(empty.path.string() + ": expected a first line") && Catch::EndsWith("found an empty one"));
  CHECK_THROWS_WITH(read_token(long_one.path), Catch::EndsWith("found 4097 characters"));
}

TEST_CASE("A token file that can't be read is named", "[server]") {
  const TempFolder folder;
  for (const std::filesystem::path& path : {folder / "nowhere", folder.path()}) {
    CHECK_THROWS_AS(read_token(path), IoError);
    CHECK_THROWS_WITH(read_token(path), Catch::StartsWith(path.string() + ": can't be read: "));
  }
}

}  // namespace
}  // namespace teracell
