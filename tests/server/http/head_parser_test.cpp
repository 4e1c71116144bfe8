// Requests as bytes: in pieces, and several in a row.
#include "server/http/head_parser.hpp"

#include "tests/support/test.hpp"

using namespace teracell;
using namespace teracell::server;

namespace {

struct Parsed {
  HeadParser::Progress progress;
  Head head;
  std::string left;  // what belongs to the next request
  int status = 0;    // of the refusal
  bool keep_alive = false;
};

// Passes two pieces as a connection does: what is left of the first comes before the second.
Parsed parsed(const std::string& text, size_t cut) {
  Parsed p;
  HeadParser parser(p.head);
  std::string_view first(text.data(), cut);
  p.progress = parser.put(first);
  std::string rest(first);
  rest += text.substr(cut);
  std::string_view second = rest;
  if (p.progress == HeadParser::kMore) p.progress = parser.put(second);
  p.left = second;
  if (p.progress == HeadParser::kRefused) p.status = parser.refusal().status;
  if (p.progress == HeadParser::kWhole) p.keep_alive = parser.keep_alive();
  return p;
}
Parsed parsed(const std::string& text) { return parsed(text, text.size()); }

const std::string kGet = "GET /a?b HTTP/1.1\r\nHost: h\r\nIf-None-Match: \"1\"\r\nif-none-match: \"2\"\r\nX-Forwarded-Prefix: /p\r\n\r\n";

}  // namespace

TEST_CASE("a head gives the same result wherever it is cut", "[server][wire]") {
  const std::string text = kGet + "GET /next";
  for (size_t cut = 0; cut <= text.size(); ++cut) {
    INFO(cut);
    const Parsed p = parsed(text, cut);
    REQUIRE(p.progress == HeadParser::kWhole);
    REQUIRE((p.head.method == "GET" && p.head.target == "/a?b" && p.head.host == "h" && p.head.http11 && p.keep_alive));
    REQUIRE((p.head.if_none_match == "\"1\", \"2\"" && p.head.forwarded_prefix == "/p"));
    REQUIRE(text.ends_with(p.left));
  }
  CHECK(parsed(text).left == "GET /next");
}

TEST_CASE("a head without its end needs more bytes, wherever it stops", "[server][wire]") {
  for (size_t n = 0; n < kGet.size(); ++n) {
    INFO(n);
    CHECK(parsed(kGet.substr(0, n)).progress == HeadParser::kMore);
  }
}

TEST_CASE("a body is skipped", "[server][wire]") {
  const std::string text = "GET / HTTP/1.1\r\nHost: h\r\nContent-Length: 5\r\n\r\nabcdeNEXT";
  for (size_t cut = 0; cut <= text.size() - 4; ++cut) {
    const Parsed p = parsed(text, cut);
    REQUIRE(p.progress == HeadParser::kWhole);
    REQUIRE(p.left == "NEXT");
  }
  CHECK(parsed(text.substr(0, text.size() - 5)).progress == HeadParser::kMore);
}

TEST_CASE("one empty line before a request is ignored, a second one is refused", "[server][wire]") {
  for (size_t cut = 0; cut <= kGet.size() + 2; ++cut) CHECK(parsed("\r\n" + kGet, cut).progress == HeadParser::kWhole);
  CHECK(parsed("\r\n\r\n" + kGet).status == 400);
  CHECK(parsed("\r" + kGet).status == 400);
  Head head;
  HeadParser parser(head);
  std::string_view line = "\r\n";
  CHECK(parser.put(line) == HeadParser::kMore);
  CHECK(line.empty());
  CHECK_FALSE(parser.begun());  // a client that ends its requests with an empty line is idle, not slow
}

TEST_CASE("a body that the client holds back until it is asked for is not waited for", "[server][wire]") {
  const auto post = [](const std::string& version, const std::string& fields) {
    return parsed(fmt::format("POST / HTTP/{}\r\nHost: h\r\nConnection: keep-alive\r\n{}\r\n", version, fields));
  };
  const Parsed p = post("1.1", "Expect: 100-Continue\r\nContent-Length: 5\r\n");
  CHECK(p.progress == HeadParser::kWhole);
  CHECK_FALSE(p.keep_alive);  // the body may come or not: what follows can't be told from a request
  CHECK(post("1.1", "Expect: 100-continue\r\nContent-Length: 8193\r\n").status == 413);
  CHECK(post("1.1", "Expect: 100-continue\r\nContent-Length: 0\r\n").keep_alive);
  CHECK(post("1.1", "Expect: 100-continue\r\n").keep_alive);
  CHECK(post("1.0", "Expect: 100-continue\r\nContent-Length: 5\r\n").progress == HeadParser::kMore);  // RFC 9110, 10.1.1
  CHECK(post("1.1", "Expect: something\r\nContent-Length: 5\r\n").progress == HeadParser::kMore);
}

TEST_CASE("a Host field that can't be one is refused", "[server][wire]") {
  const auto host = [](const std::string& value) { return parsed("GET / HTTP/1.1\r\nHost:" + value + "\r\n\r\n").status; };
  for (const char* good : {"h", " h:80 ", " [::1]:80", " a.b-c_d"}) CHECK(host(good) == 0);
  for (const char* bad : {"", " ", " a b", " h/x", " http://h", " user@h", " h:x", " [::1", " h,h2/", " <h>", " h\\", " h#x"}) {
    INFO(bad);
    CHECK(host(bad) == 400);
  }
  CHECK(parsed("GET / HTTP/1.0\r\nHost: a b\r\n\r\n").status == 400);
  CHECK(parsed("GET http://good/ HTTP/1.1\r\nHost: a b\r\n\r\n").status == 400);
  CHECK(parsed("GET http://good/ HTTP/1.1\r\n\r\n").status == 400);
  Head head;
  HeadParser parser(head);
  const std::string text = "GET / HTTP/1.1\r\nHost: " + std::string(9000, '@') + "\r\n\r\n";
  std::string_view bytes = text;
  REQUIRE(parser.put(bytes) == HeadParser::kRefused);
  CHECK(parser.refusal().body->size() < 200);
}

TEST_CASE("a target of no form, or of another method's, is refused", "[server][wire]") {
  const auto target = [](const std::string& method, const std::string& value) {
    return parsed(method + " " + value + " HTTP/1.1\r\nHost: h\r\n\r\n").status;
  };
  for (const char* good : {"/", "//", "/?a", "http://h", "HTTP://H/a", "hTTps://h:1/?b"}) CHECK(target("GET", good) == 0);
  for (const char* bad :
       {"*", "h:80", "a", "?a", "http:", "http:/a", "http://", "http:///a", "http://?a", "ftp://h/", "http://u@h/", "http://h:x/", "http://h#a"}) {
    INFO(bad);
    CHECK(target("GET", bad) == 400);
  }
  CHECK(target("OPTIONS", "*") == 0);
  CHECK(target("OPTIONS", "h:80") == 400);
  CHECK(target("CONNECT", "h:80") == 0);
}

TEST_CASE("heads that are refused", "[server][wire]") {
  const auto get = [](const std::string& fields) { return parsed("GET / HTTP/1.1\r\nHost: h\r\n" + fields + "\r\n").status; };
  CHECK(get("a b: c\r\n") == 400);
  CHECK(get("Host: h\r\n") == 400);
  CHECK(get("Content-Length: -1\r\n") == 400);
  CHECK(get("Content-Length: 8193\r\n") == 413);
  CHECK(get("Transfer-Encoding: chunked\r\n") == 413);
  CHECK(get("X: " + std::string(HeadParser::kMaxHead, 'x') + "\r\n") == 431);
  CHECK(parsed("GET /" + std::string(HeadParser::kMaxHead, 'a')).status == 414);
  CHECK(parsed("GET / HTTP/2.0\r\nHost: h\r\n\r\n").status == 505);
  CHECK(parsed("GET / HTTP/1.1\r\n\r\n").status == 400);
  CHECK(parsed("GET / HTTP/1.0\r\n\r\n").progress == HeadParser::kWhole);
  CHECK(get("X: " + std::string(HeadParser::kMaxHead - 100, 'x') + "\r\n") == 0);
}
