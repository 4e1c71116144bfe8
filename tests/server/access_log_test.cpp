// Lines of the access log: nothing in them is the client's to steer.
#include "server/access_log.hpp"

#include <unistd.h>

#include <catch2/catch.hpp>
#include <nlohmann/json.hpp>

using namespace teracell;

namespace {

std::string line(LogFormat format, std::string_view target, std::string_view method = "GET") {
  std::string out;
  append_log_line(out, format, "TIME", {"::1", method, target, 200, 12, 0.25, "tile"});
  return out;
}

}  // namespace

TEST_CASE("a line of text", "[server][log]") {
  CHECK(line(LogFormat::kText, "/a?b=c") == "TIME ::1 GET /a?b=c 200 12 0.250 tile\n");
  CHECK(line(LogFormat::kText, "", "") == "TIME ::1 - - 200 12 0.250 tile\n");
}

TEST_CASE("a line of JSON", "[server][log]") {
  const auto j = nlohmann::json::parse(line(LogFormat::kJson, "/a"));
  CHECK(j == nlohmann::json{{"time", "TIME"}, {"client", "::1"}, {"method", "GET"}, {"target", "/a"}, {"status", 200}, {"bytes", 12}, {"ms", 0.25}, {"route", "tile"}});
}

TEST_CASE("every byte of a target comes out as printable ASCII, and JSON stays JSON", "[server][log]") {
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  for (const LogFormat format : {LogFormat::kText, LogFormat::kJson}) {
    const std::string out = line(format, all, all);
    REQUIRE(out.back() == '\n');
    for (const char c : out.substr(0, out.size() - 1)) REQUIRE((c >= 0x20 && c < 0x7f));
  }
  CHECK(line(LogFormat::kText, "/\x1b[31m\"\\") == "TIME ::1 GET /%1B[31m%22%5C 200 12 0.250 tile\n");
  CHECK_NOTHROW(nlohmann::json::parse(line(LogFormat::kJson, all, all)));
}

TEST_CASE("a long target is cut", "[server][log]") {
  CHECK(line(LogFormat::kText, std::string(20000, 'a')) == "TIME ::1 GET " + std::string(1024, 'a') + "... 200 12 0.250 tile\n");
}

TEST_CASE("lines are gathered until flushed, with the time in front", "[server][log]") {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  {
    AccessLog log(LogFormat::kText, ends[1]);
    log.write({"::1", "GET", "/a", 200, 1, 1, "x"});
    log.write({"::1", "GET", "/b", 200, 1, 1, "x"});
  }
  close(ends[1]);
  char text[200] = {};
  REQUIRE(read(ends[0], text, sizeof text - 1) > 0);
  close(ends[0]);
  const std::string out = text;
  CHECK(std::count(out.begin(), out.end(), '\n') == 2);
  CHECK(out.substr(23, 18) == "Z ::1 GET /a 200 1");
  CHECK((out[4] == '-' && out[10] == 'T' && out[19] == '.'));
}
