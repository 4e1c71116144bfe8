// Lines of the access log: no client can put control characters or quotes into them.
#include "server/http/access_log.hpp"

#include "tests/support/pipe.hpp"

using namespace teracell;
using namespace teracell::server;
using teracell::testing::Pipe;

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

TEST_CASE("an answer that was cut is told as such", "[server][log]") {
  const LogEntry cut{"::1", "GET", "/a", 200, 12, 0.25, "slice", true};
  std::string text, json;
  append_log_line(text, LogFormat::kText, "TIME", cut);
  append_log_line(json, LogFormat::kJson, "TIME", cut);
  CHECK(text == "TIME ::1 GET /a 200 12 0.250 slice cut\n");
  CHECK(nlohmann::json::parse(json)["cut"] == true);
  CHECK_FALSE(nlohmann::json::parse(line(LogFormat::kJson, "/a")).contains("cut"));
}

TEST_CASE("a line of JSON", "[server][log]") {
  const auto j = nlohmann::json::parse(line(LogFormat::kJson, "/a"));
  CHECK(
      j ==
      nlohmann::json{
          {"time", "TIME"}, {"client", "::1"}, {"method", "GET"}, {"target", "/a"}, {"status", 200}, {"bytes", 12}, {"ms", 0.25}, {"route", "tile"}});
}

TEST_CASE("every byte of a target is written as printable ASCII, and JSON stays valid", "[server][log]") {
  std::string all;
  for (int c = 0; c < 256; ++c) all += static_cast<char>(c);
  for (const LogFormat format : {LogFormat::kText, LogFormat::kJson}) {
    const std::string out = line(format, all, all);
    REQUIRE(out.back() == '\n');
    for (const char c : out.substr(0, out.size() - 1)) REQUIRE((c >= 0x20 && c < 0x7f));
  }
  CHECK(line(LogFormat::kText, "/\x1b[31m\"\\") == "TIME ::1 GET /%1B[31m%22%5C 200 12 0.250 tile\n");
  CHECK(nlohmann::json::accept(line(LogFormat::kJson, all, all)));
}

TEST_CASE("a long target is cut", "[server][log]") {
  CHECK(line(LogFormat::kText, std::string(20000, 'a')) == "TIME ::1 GET " + std::string(1024, 'a') + "... 200 12 0.250 tile\n");
}

TEST_CASE("lines and notes begin with the time, and finish() writes all of them", "[server][log]") {
  Pipe pipe;
  {
    AccessLog log(LogFormat::kText, pipe.in);
    log.write({"::1", "GET", "/a", 200, 1, 1, "x"});
    log.note("a note");
    log.write({"::1", "GET", "/b", 200, 1, 1, "x"});
  }
  std::string out = pipe.rest();
  std::ranges::replace_if(
      out, [](char c) { return c >= '0' && c <= '9'; }, '0');
  const std::string time = "0000-00-00T00:00:00.000Z";
  CHECK(out == time + " ::0 GET /a 000 0 0.000 x\nteracell: a note\n" + time + " ::0 GET /b 000 0 0.000 x\n");
}

TEST_CASE("notes are written without a log of requests, and as JSON in a JSON log", "[server][log]") {
  Pipe none, as_json;
  {
    AccessLog log(LogFormat::kNone, none.in), j(LogFormat::kJson, as_json.in);
    log.write({"::1", "GET", "/a", 200, 1, 1, "x"});
    log.note("a note");
    j.note("a \"note\" \xff");
  }
  CHECK(none.rest() == "teracell: a note\n");
  CHECK(nlohmann::json::parse(as_json.rest())["message"] == "a \"note\" \xef\xbf\xbd");
}

TEST_CASE("lines that nobody reads are dropped instead of waiting; the log says how many when it is read again", "[server][log][threads]") {
  Pipe pipe;
  AccessLog log(LogFormat::kText, pipe.in);
  const std::string target(1000, 'a');
  constexpr size_t kEach = AccessLog::kMost / 1000, kLines = 4 * kEach;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        for (size_t i = 0; i < kEach; ++i) log.write({"::1", "GET", target, 200, 1, 1, "x"});
      });
  }
  const uint64_t dropped = log.dropped();
  CHECK(dropped > 0);
  auto out = std::async(std::launch::async, [&] { return pipe.rest(kLines - dropped); });
  REQUIRE(out.wait_for(std::chrono::seconds(20)) == std::future_status::ready);
  const std::string text = out.get();
  log.finish();
  const std::string all = text + pipe.rest();
  uint64_t told = 0;
  size_t lines = 0;
  const std::string notice = "teracell: ";
  std::istringstream in(all);
  for (std::string line; std::getline(in, line); ++lines)
    if (line.starts_with(notice)) told += std::stoul(line.substr(notice.size())), --lines;
  CHECK(told == dropped);
  CHECK(lines == kLines - dropped);
  CHECK(log.dropped() == dropped);
}

TEST_CASE("finish() does not wait for ever for a reader", "[server][log]") {
  Pipe pipe;
  AccessLog log(LogFormat::kText, pipe.in);
  for (int i = 0; i < 1000; ++i) log.write({"::1", "GET", std::string(1000, 'a'), 200, 1, 1, "x"});
  log.finish();
  CHECK(log.dropped() > 0);
  log.write({"::1", "GET", "/late", 200, 1, 1, "x"});
  CHECK(pipe.rest().find("/late") == std::string::npos);
}

TEST_CASE("lines of a log whose reader has gone are lost and counted", "[server][log]") {
  std::signal(SIGPIPE, SIG_IGN);  // as the program does
  Pipe pipe;
  pipe.close_out();
  AccessLog log(LogFormat::kText, pipe.in);
  for (int i = 0; i < 10; ++i) log.write({"::1", "GET", "/a", 200, 1, 1, "x"});
  log.finish();
  CHECK(log.dropped() == 10);
}
