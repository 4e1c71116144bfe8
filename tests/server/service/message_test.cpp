// Responses that say what went wrong, and the ETags that a client names.
#include "server/service/message.hpp"

#include "tests/support/test.hpp"

using namespace teracell;
using namespace teracell::server;

TEST_CASE("an error is JSON, whatever its message", "[server]") {
  const Response r = error_response(400, "bad_request", "a \"b\" \n \xff \xc3\xbc");
  CHECK(*r.body == R"({"error":{"code":"bad_request","message":"a \"b\" \n \ufffd \u00fc"}})");
  CHECK((r.status == 400 && r.content_type == "application/json" && r.cache_control == "no-store"));
}

TEST_CASE("an error's message is cut when a file makes it long", "[server]") {
  CHECK(error_response(500, "damaged", std::string(1 << 20, 'x') + " is wrong").body->size() < 1200);
}

TEST_CASE("an ETag is found in a list, weak or strong, and never as a part of another", "[server]") {
  for (const char* yes : {"\"a-1\"", "W/\"a-1\"", "\"b\", \"a-1\"", "\"a-1\",\"b\"", "\"xa-1\", \"a-1\"", "*"}) {
    INFO(yes);
    CHECK(has_etag(yes, "\"a-1\""));
  }
  for (const char* no : {"", "a-1", "\"a-1", "\"a-1-gz\"", "\"A-1\"", "x\"a-1\"", "\"a-1\"x", "**"}) {
    INFO(no);
    CHECK_FALSE(has_etag(no, "\"a-1\""));
  }
}
