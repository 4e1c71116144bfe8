// Host names and origins: what is one, and which of them a server takes.
#include "server/http/host.hpp"

#include "tests/support/test.hpp"

using namespace teracell;
using namespace teracell::server;

TEST_CASE("what a Host field may hold", "[server][wire]") {
  for (const char* good : {"h", "example.org", "example.org:8080", "example.org:", "127.0.0.1", "127.0.0.1:1", "[::1]", "[::1]:65535",
                           "[1:2::3.4.5.6]", "a_b~c", "%41b", "a!$&'()*+,;=b", "h."}) {
    INFO(good);
    CHECK(is_authority(good));
  }
  for (const char* bad : {"",        ":80",    "a b",    "a/b",     "a\\b",           "a?b",    "a#b",         "user@h", "<h>",      "\"h\"",
                          "h:80:80", "h:x",    "h:-1",   "h:65536", "h: 1",           "%4",     "%zz",         "::1",    "[::1",     "::1]",
                          "[]",      "[::1]x", "x[::1]", "[::g]",   "[fe80::1%eth0]", "[v1.x]", "[127.0.0.1]", "a\x01",  "\xc3\xa9", "h]:80",
                          "[[::1]]"}) {
    INFO(bad);
    CHECK_FALSE(is_authority(bad));
  }
  CHECK(is_authority(std::string(255, 'a')));
  CHECK_FALSE(is_authority(std::string(256, 'a')));
  CHECK_FALSE(is_authority(std::string_view("a\0b", 3)));
  CHECK_FALSE(is_authority(std::string_view("[::1\0x]", 7)));
  CHECK((is_host_name("example.org") && is_host_name("[::1]")));
  CHECK_FALSE((is_host_name("example.org:80") || is_host_name("h:") || is_host_name("")));
}

TEST_CASE("loopback names are always allowed, and only they when nothing else is", "[server][wire]") {
  for (const char* here : {"localhost", "LocalHost:8080", "localhost.", "grids.localhost", "a.b.localhost.:1", "127.0.0.1", "127.0.0.1:8080",
                           "127.255.3.4", "[::1]", "[::1]:8080", "[0:0:0:0:0:0:0:1]"}) {
    INFO(here);
    CHECK(allows_host({}, here));
    CHECK(allowed_origin({}, std::string("http://") + here) == std::string("http://") + here);
  }
  for (const char* other :
       {"example.org", "localhost.example.org", "127.0.0.1.example.org", "notlocalhost", ".localhost", "127.0.0", "127.1", "127.0.0.256",
        "127.0.0.1.2", "128.0.0.1", "0.0.0.0", "[::2]", "[::ffff:127.0.0.1]", "local", "", "localhost..", "local%68ost", "localhost@evil"}) {
    INFO(other);
    CHECK_FALSE(allows_host({}, other));
    CHECK(allowed_origin({}, std::string("http://") + other).empty());
  }
}

TEST_CASE("other names and origins are allowed by lists", "[server][wire]") {
  const std::vector<std::string> hosts = {"grids.example.org", "[fd00::1]"};
  for (const char* good : {"grids.example.org", "GRIDS.Example.org:443", "grids.example.org.", "[fd00::1]:80", "localhost"})
    CHECK(allows_host(hosts, good));
  for (const char* bad : {"example.org", "a.grids.example.org", "grids.example.org.evil", "xgrids.example.org", "[fd00::2]"})
    CHECK_FALSE(allows_host(hosts, bad));
  CHECK(allows_host({"*"}, "anything.example"));

  const std::vector<std::string> origins = {"https://a.example", "http://b.example:8080"};
  for (const char* good : {"https://a.example", "HTTPS://A.example", "http://b.example:8080", "https://localhost:5173", "http://[::1]:80"})
    CHECK(allowed_origin(origins, good) == good);
  for (const char* bad :
       {"", "null", "http://a.example", "https://a.example:444", "http://b.example", "https://a.example.evil", "https://x.a.example", "file://",
        "file://localhost", "localhost", "//localhost", "http://localhost/", "http://evil@localhost"})
    CHECK(allowed_origin(origins, bad).empty());
  CHECK(allowed_origin({"*"}, "null") == "*");
  CHECK(allowed_origin({"*"}, "") == "*");
}

TEST_CASE("what is an origin", "[server][wire]") {
  for (const char* good : {"https://example.org", "http://example.org:8080", "http://[::1]"}) CHECK(is_web_origin(good));
  for (const char* bad :
       {"", "*", "null", "example.org", "https://", "https://example.org/", "https://example.org/a", "ftp://example.org", "https://a b"})
    CHECK_FALSE(is_web_origin(bad));
}
