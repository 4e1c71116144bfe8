// The texts of /metrics and /healthz, read line by line as Prometheus reads them.
#include "server/operations/metrics.hpp"

#include "store/base/system/system.hpp"
#include "tests/support/test.hpp"

using namespace teracell;
using namespace teracell::server;

namespace {

// Name with labels -> value. Checks that every sample is below its TYPE and that no TYPE and no sample is there twice.
std::map<std::string, double> samples(const std::string& text) {
  std::map<std::string, double> out;
  std::set<std::string> types;
  std::string line, type;
  std::istringstream in(text);
  while (std::getline(in, line)) {
    if (line.starts_with("# HELP ")) continue;
    if (line.starts_with("# TYPE ")) {
      type = line.substr(7, line.find(' ', 7) - 7);
      REQUIRE(types.insert(type).second);
      continue;
    }
    INFO(line);
    REQUIRE(line.starts_with(type));
    const size_t space = line.rfind(' ');
    size_t used = 0;
    const double value = std::stod(line.substr(space + 1), &used);
    REQUIRE(space + 1 + used == line.size());
    REQUIRE(out.emplace(line.substr(0, space), value).second);
  }
  REQUIRE(text.ends_with('\n'));
  return out;
}

}  // namespace

TEST_CASE("requests are counted by route and status, their durations by route", "[server][metrics]") {
  Metrics m;
  m.request("tile", 200, 0.0002);
  m.request("tile", 200, 0.0003);
  m.request("tile", 404, 0.02);
  m.request("stats", 200, 99);
  const auto s = samples(metrics_text(m, {}));
  CHECK(s.at(R"(teracell_requests_total{route="tile",status="200"})") == 2);
  CHECK(s.at(R"(teracell_requests_total{route="tile",status="404"})") == 1);
  CHECK(s.at(R"(teracell_requests_total{route="stats",status="200"})") == 1);
  const std::string bucket = "teracell_request_duration_seconds_bucket";
  CHECK(s.at(bucket + R"({route="tile",le="0.0001"})") == 0);
  CHECK(s.at(bucket + R"({route="tile",le="0.0003"})") == 2);  // a bound belongs to its bucket
  CHECK(s.at(bucket + R"({route="tile",le="0.01"})") == 2);
  CHECK(s.at(bucket + R"({route="tile",le="0.03"})") == 3);
  CHECK(s.at(bucket + R"({route="tile",le="+Inf"})") == 3);
  CHECK(s.at(bucket + R"({route="stats",le="30"})") == 0);
  CHECK(s.at(bucket + R"({route="stats",le="+Inf"})") == 1);
  CHECK(s.at(R"(teracell_request_duration_seconds_count{route="tile"})") == 3);
  CHECK(s.at(R"(teracell_request_duration_seconds_sum{route="tile"})") == Approx(0.0205));
}

TEST_CASE("equal names are one route, whatever the pointer; too many routes are counted together", "[server][metrics]") {
  Metrics m;
  std::vector<std::string> names;
  for (int i = 0; i < 50; ++i) names.push_back(fmt::format("r{}", i));
  const std::string again = "r3";
  for (const std::string& name : names) m.request(name.c_str(), 200, 0);
  m.request(again.c_str(), 200, 0);
  double sum = 0;
  const auto s = samples(metrics_text(m, {}));
  for (const auto& [name, value] : s)
    if (name.starts_with("teracell_requests_total")) sum += value;
  CHECK(sum == 51);
  CHECK(s.at(R"(teracell_requests_total{route="r3",status="200"})") == 2);
  CHECK(s.at(R"(teracell_requests_total{route="more",status="200"})") == 19);
}

TEST_CASE("threads count without losing any", "[server][metrics][threads]") {
  Metrics m;
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t)
      threads.emplace_back([&] {
        for (int i = 0; i < 2000; ++i) m.request(i % 2 ? "odd" : "even", 200, 0.001);
      });
  }
  const auto s = samples(metrics_text(m, {}));
  CHECK(s.at(R"(teracell_requests_total{route="odd",status="200"})") == 4000);
  CHECK(s.at(R"(teracell_requests_total{route="even",status="200"})") == 4000);
}

TEST_CASE("a part of a counter counts as long as it lives, wherever it is moved", "[server][metrics]") {
  std::atomic<uint64_t> n{0};
  {
    Counted a(n), b(n, 10);
    CHECK(n == 11);
    Counted c(std::move(a));
    CHECK_FALSE(a);
    CHECK(n == 11);
    b = {};
    CHECK(n == 1);
    b = std::move(c);
    CHECK(b);
    CHECK(n == 1);
  }
  CHECK(n == 0);
}

TEST_CASE("the state of caches, files, connections and memory", "[server][metrics]") {
  Metrics m;
  m.connections = 3;
  m.refused = 4;
  m.held_bytes = 5;
  const auto s = samples(metrics_text(m, {{{"chunks", {1, 2, 3, 4}}, {"answers", {5, 6, 7, 8}}}, 9, 10, 11, 12, 13, 14, "1.2.3"}));
  CHECK(s.at(R"(teracell_cache_bytes{cache="chunks"})") == 1);
  CHECK(s.at(R"(teracell_cache_limit_bytes{cache="answers"})") == 6);
  CHECK(s.at(R"(teracell_cache_hits_total{cache="chunks"})") == 3);
  CHECK(s.at(R"(teracell_cache_misses_total{cache="answers"})") == 8);
  CHECK(s.at("teracell_grids") == 9);
  CHECK(s.at("teracell_reads_total") == 10);
  CHECK(s.at("teracell_read_bytes_total") == 11);
  CHECK(s.at("teracell_damaged_total") == 12);
  CHECK(s.at("teracell_log_dropped_total") == 13);
  CHECK(s.at("process_resident_memory_bytes") == 14);
  CHECK(s.at(R"(teracell_build_info{version="1.2.3"})") == 1);
  CHECK(s.at("teracell_connections") == 3);
  CHECK(s.at("teracell_held_bytes") == 5);
  CHECK(s.at(R"(teracell_connections_dropped_total{reason="full"})") == 4);
  CHECK(system::resident_bytes() > 1e6);
}

TEST_CASE("health and metrics are answered before the inner handler is asked", "[server][metrics]") {
  Metrics m;
  const Response mine{.status = 200, .body = body_of("inner")};
  const Handler h = with_operations(
      {[&](const Request& r) { return r.target == "/warm" ? std::optional(mine) : std::nullopt; }, [&](const Request&) { return mine; }}, m,
      [] { return ServerState{.version = "9"}; });
  const auto at_once = [&](const std::string& target) { return h.at_once({.target = target}); };
  CHECK(*at_once("/healthz")->body == R"({"status":"ok"})");
  CHECK(at_once("/healthz?x")->route == std::string("healthz"));
  CHECK(samples(*at_once("/metrics")->body).at(R"(teracell_build_info{version="9"})") == 1);
  CHECK(*at_once("/warm")->body == "inner");
  CHECK_FALSE(at_once("/healthz/x"));
  CHECK(*h.handle({.target = "/cold"}).body == "inner");
}
