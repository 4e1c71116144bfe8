// Token files: what may be a token, and what the messages say of the rest.
#include "server/http/token.hpp"

#include <sys/stat.h>

#include "store/base/error.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::server {
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
  CHECK_THROWS_WITH(read_token(long_one.path), Catch::EndsWith("found a longer one"));
}

TEST_CASE("A token file that can't be read is named", "[server]") {
  const TempFolder folder;
  CHECK_THROWS_AS(read_token(folder / "nowhere"), IoError);
  CHECK_THROWS_WITH(read_token(folder / "nowhere"), Catch::StartsWith((folder / "nowhere").string() + ": can't open: "));
  CHECK_THROWS_AS(read_token(folder.path()), IoError);
  CHECK_THROWS_WITH(read_token(folder.path()), folder.path().string() + ": expected a file, found a folder");
}

TEST_CASE("A pipe is refused as a token file, and not waited for", "[server]") {
  const TempFolder folder;
  REQUIRE(mkfifo((folder / "pipe").c_str(), 0600) == 0);
  CHECK_THROWS_AS(read_token(folder / "pipe"), IoError);
  CHECK_THROWS_WITH(read_token(folder / "pipe"), Catch::EndsWith("expected a file, found a device or a pipe"));
}

TEST_CASE("It is known whether others may read the token", "[server]") {
  const TokenFile file("secret");
  for (const auto& [mode, others] : {std::pair(0600, false), {0400, false}, {0700, false}, {0622, false}, {0640, true}, {0604, true}, {0644, true}}) {
    CAPTURE(mode);
    REQUIRE(chmod(file.path.c_str(), mode) == 0);
    CHECK(others_can_read(file.path) == others);
  }
  CHECK_FALSE(others_can_read(file.folder / "nowhere"));
}

}  // namespace
}  // namespace teracell::server
