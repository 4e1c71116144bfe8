// Heads of requests and of responses as text.
#include "server/http/wire.hpp"

#include "tests/support/test.hpp"

using namespace teracell;
using namespace teracell::server;

namespace {

Head head_for(std::string target) {
  Head h;
  h.method = "GET";
  h.target = std::move(target);
  h.host = "example.org:8080";
  return h;
}

Request request_of(const Head& head, std::string_view base_path = "") {
  Request r;
  Head read = head;
  REQUIRE(read_target(read));
  fill_request(r, read, base_path, "127.0.0.1:8080");
  return r;
}

std::string head_of(const Response& r, const Sending& s = {true, true, "DATE"}) {
  std::string out;
  append_head(out, r, s);
  return out;
}

bool has_line(const std::string& head, const std::string& line) { return head.find("\r\n" + line + "\r\n") != std::string::npos; }

}  // namespace

TEST_CASE("a client accepts gzip when it names it and does not refuse it", "[server][wire]") {
  for (const char* yes :
       {"gzip", "GZIP", "deflate, gzip;q=0.5", "br;q=1, x-gzip", "gzip ; q=0.001", "*", "identity;q=0, *;q=0.1", "gzip;q=1, *;q=0"}) {
    INFO(yes);
    CHECK(accepts_gzip(yes));
  }
  for (const char* no : {"", "identity", "br", "gzip;q=0", "gzip; q=0.000", "GZIP;Q=0.0", "*;q=0", "*, gzip;q=0", "gzipped", ",,;;"}) {
    INFO(no);
    CHECK_FALSE(accepts_gzip(no));
  }
}

TEST_CASE("the answer to HEAD is never encoded", "[server][wire]") {
  Head h = head_for("/");
  h.accept_encoding = "gzip";
  CHECK(request_of(h).accepts_gzip);
  h.method = "HEAD";
  CHECK_FALSE(request_of(h).accepts_gzip);
}

TEST_CASE("links begin with the server's name as proxies and clients know it, if that can stand in a link", "[server][wire]") {
  Head h = head_for("/");
  CHECK(request_of(h).origin == "http://example.org:8080");
  CHECK(request_of(h).prefix == "");
  CHECK(request_of(h, "/grids").prefix == "/grids");
  h.forwarded_proto = "https, http";
  h.forwarded_host = "public.example, inner";
  h.forwarded_prefix = "/sub/";
  CHECK(request_of(h).origin == "https://public.example");
  CHECK(request_of(h, "/grids").prefix == "/sub/grids");
  for (const char* bad : {"a b", "x\"y", "<script>", "a/b", "a\\b", "", "user@host"}) {
    INFO(bad);
    h.forwarded_host = bad;
    CHECK(request_of(h).origin == "https://example.org:8080");
  }
  for (const char* bad : {"//evil.example", "/a//b", "sub", "/a b", "/<x>", "/a?b", "/%2f", "/a\""}) {
    INFO(bad);
    h.forwarded_prefix = bad;
    CHECK(request_of(h).prefix == "");
  }
  h.forwarded_proto = "javascript";
  h.host = "bad host";
  CHECK(request_of(h).origin == "http://127.0.0.1:8080");
  h.host = "[::1]:8080";
  CHECK(request_of(h).origin == "http://[::1]:8080");
}

TEST_CASE("of a target with scheme and host the path is used", "[server][wire]") {
  CHECK(request_of(head_for("/a?b=http://c/")).target == "/a?b=http://c/");
  CHECK(request_of(head_for("http://example.org/a?b")).target == "/a?b");
  CHECK(request_of(head_for("https://example.org")).target == "/");
  CHECK(request_of(head_for("http://h?x=/healthz")).target == "/?x=/healthz");
  CHECK(request_of(head_for("HTTP://H/a")).target == "/a");
  CHECK(request_of(head_for("http://h//evil/x")).target == "//evil/x");
  CHECK(request_of(head_for("http://other:1/a")).origin == "http://other:1");  // not that of the Host field
  CHECK(request_of(head_for("https://other")).origin == "https://other");
  Head forwarded = head_for("https://other/a");
  forwarded.forwarded_proto = "http";
  CHECK(request_of(forwarded).origin == "http://other");
}

TEST_CASE("the base path is removed in whole segments only", "[server][wire]") {
  const auto without = [](std::string target, std::string_view base) { return take_off_base(target, base) ? target : "no"; };
  CHECK(without("/x/a?b", "/x") == "/a?b");
  CHECK(without("/x/", "/x") == "/");
  CHECK(without("/x", "/x") == "");
  CHECK(without("/x?q", "/x") == "?q");
  CHECK(without("/xy", "/x") == "no");
  CHECK(without("/", "/x") == "no");
  CHECK(without("/a", "") == "/a");
  CHECK(without("a", "") == "no");
  CHECK(is_base_path(""));
  CHECK(is_base_path("/a/b-c_d.e~"));
  for (const char* bad : {"/", "a", "/a/", "//a", "/a b", "/a%20"}) CHECK_FALSE(is_base_path(bad));
}

TEST_CASE("only the exact token is accepted", "[server][wire]") {
  CHECK(bears_token("Bearer secret", "secret"));
  CHECK(bears_token("bearer   secret ", "secret"));
  for (const char* bad :
       {"", "Bearer", "Bearer ", "secret", "Basic secret", "Bearer secre", "Bearer secrets", "Bearer secretsecret", "Bearer Secret", "Bearer s"}) {
    INFO(bad);
    CHECK_FALSE(bears_token(bad, "secret"));
  }
}

TEST_CASE("a response's head", "[server][wire]") {
  Response r{.status = 200,
             .content_type = "application/json",
             .body = body_of("{}"),
             .etag = "\"e\"",
             .cache_control = "no-cache",
             .content_encoding = "gzip"};
  const std::string head = head_of(r);
  CHECK(head.starts_with("HTTP/1.1 200 OK\r\n"));
  CHECK(head.ends_with("\r\n\r\n"));
  for (const char* line : {"Server: teracell", "Date: DATE", "Content-Type: application/json", "Content-Length: 2", "ETag: \"e\"",
                           "Cache-Control: no-cache", "Content-Encoding: gzip", "Vary: Accept-Encoding", "Access-Control-Allow-Origin: *",
                           "Access-Control-Expose-Headers: *", "X-Content-Type-Options: nosniff"})
    CHECK(has_line(head, line));
  CHECK(head.find("Connection:") == std::string::npos);
  CHECK(has_line(head_of(r, {false, true, "DATE"}), "Connection: close"));
  CHECK(has_line(head_of(r, {true, false, "DATE"}), "Connection: keep-alive"));
  r.content_type = "image/png";
  CHECK(head_of(r).find("Vary") == std::string::npos);
}

TEST_CASE("when not every page may read an answer, caches are told that it depends on the page", "[server][wire]") {
  const std::string allowed = head_of({}, {true, true, "DATE", "http://localhost:1"}), other = head_of({}, {true, true, "DATE", ""});
  CHECK(has_line(allowed, "Access-Control-Allow-Origin: http://localhost:1"));
  CHECK((has_line(allowed, "Vary: Origin") && has_line(other, "Vary: Origin")));
  CHECK(other.find("Access-Control-Allow-Origin") == std::string::npos);
  CHECK(head_of({}).find("Origin\r\n") == std::string::npos);
}

TEST_CASE("a body with a rest is sent in chunks, or to HTTP/1.0 until the end of the connection", "[server][wire]") {
  struct Nothing : Parts {
    bool append(std::string&) override { return false; }
    size_t memory() const override { return 0; }
  };
  const Response r{.body = body_of("a"), .rest = std::make_shared<Nothing>()};
  CHECK(has_line(head_of(r), "Transfer-Encoding: chunked"));
  for (const bool http11 : {true, false}) CHECK(head_of(r, {!http11, http11, "DATE"}).find("Content-Length") == std::string::npos);
  CHECK(head_of(r, {false, false, "DATE"}).find("Transfer-Encoding") == std::string::npos);
}

TEST_CASE("fields that depend on the status", "[server][wire]") {
  CHECK(has_line(head_of({.status = 404}), "Content-Length: 0"));
  CHECK(head_of({.status = 304}).find("Content-Length") == std::string::npos);
  CHECK(head_of({.status = 204}).find("Content-Length") == std::string::npos);
  CHECK(has_line(head_of({.status = 204}), "Access-Control-Allow-Headers: range, if-none-match, authorization"));
  CHECK(has_line(head_of({.status = 401}), "WWW-Authenticate: Bearer realm=\"teracell\""));
  CHECK(has_line(head_of({.status = 405}), "Allow: GET, HEAD, OPTIONS"));
  CHECK(head_of({.status = 503}).find("Retry-After") == std::string::npos);
  CHECK(has_line(head_of(try_again("overloaded", "")), "Retry-After: 1"));
}

TEST_CASE("no value can end its line", "[server][wire]") {
  CHECK(has_line(head_of({.status = 302, .location = "/a\r\nSet-Cookie: b\x7f"}), "Location: /a??Set-Cookie: b?"));
}

TEST_CASE("a date as RFC 9110 writes it", "[server][wire]") {
  CHECK(http_date(784111777) == "Sun, 06 Nov 1994 08:49:37 GMT");
  CHECK(http_date(0) == "Thu, 01 Jan 1970 00:00:00 GMT");
}
