// Requests as bytes: in pieces, and several in a row.
#include "server/http/head_parser.hpp"

#include <catch2/catch.hpp>

using namespace teracell;

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
