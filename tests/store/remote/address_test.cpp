// Addresses: what they are made of, and which are refused before anybody is asked.
#include "store/remote/remote_object.hpp"
#include "store/remote/sources.hpp"
#include "store/remote/url.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

TEST_CASE("What is an address, and what is the name of a file") {
  for (const char* address : {"https://h/g.tcell", "s3://b/k", "HTTP://h", "x+y-1.z://"}) REQUIRE(is_address(address));
  for (const char* name : {"g.tcell", "/a://b", "://b", "a/b://c", "1a://b", ""}) REQUIRE_FALSE(is_address(name));
}

TEST_CASE("Loopback is this machine alone") {
  for (const char* host : {"localhost", "127.0.0.1", "127.1.2.3", "[::1]"}) REQUIRE(is_loopback(host));
  for (const char* host : {"127.example.org", "127.0.0.1.example.org", "128.0.0.1", "localhost.example.org", "[::2]", "127.1"})
    REQUIRE_FALSE(is_loopback(host));
}

TEST_CASE("Names and passwords in addresses are refused, and no message shows them or a query") {
  REQUIRE_THROWS_WITH(parse_url("https://me:secret@host/g"), !Catch::Contains("secret"));
  const Url url = parse_url("https://Host:444/a b/%41?signature=secret#part");
  REQUIRE(url.shown() == "https://Host:444/a%20b/%41");
  REQUIRE(url.query == "signature=secret");
  REQUIRE(url.port == "444");
  REQUIRE(parse_url("https://h/").origin() == parse_url("https://h:443/x").origin());
  REQUIRE(parse_url("https://h/").origin() != parse_url("http://h/").origin());
}

TEST_CASE("HTTP without TLS is for this machine") {
  expect_allowed(parse_url("https://example.org/g"), false);
  expect_allowed(parse_url("http://127.0.0.1:80/g"), false);
  expect_allowed(parse_url("http://example.org/g"), true);
  REQUIRE_THROWS_AS(expect_allowed(parse_url("http://example.org/g"), false), UsageError);
  REQUIRE_THROWS_AS(expect_allowed(parse_url("file:///g"), true), UsageError);
}

TEST_CASE("Paths are encoded as signatures want them") { REQUIRE(encoded_path("a b/+&=~-._é%") == "a%20b/%2B%26%3D~-._%C3%A9%25"); }

TEST_CASE("Content-Range is taken only as the standard writes it") {
  const auto r = parse_content_range("bytes 5-9/100");
  REQUIRE((r && r->first == 5 && r->last == 9 && r->size == 100));
  for (const char* bad : {"", "bytes", "bytes 5-9", "bytes 5-9/*", "bytes */100", "bytes 9-5/100", "bytes 5-100/100", "bytes 5-9/100 ",
                          "items 5-9/100", "bytes -5-9/100", "bytes 5-9/99999999999999999999999"})
    REQUIRE_FALSE(parse_content_range(bad));
}

}  // namespace
}  // namespace teracell
