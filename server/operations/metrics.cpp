#include "server/operations/metrics.hpp"
#include <algorithm>
#include <cstring>
#include <iterator>

#include <fmt/format.h>

#include "server/service/target.hpp"

namespace teracell::server {
namespace {

constexpr auto kRelaxed = std::memory_order_relaxed;

void describe(std::string& out, const char* name, const char* type, const char* help) {
  fmt::format_to(std::back_inserter(out), "# HELP {0} {2}\n# TYPE {0} {1}\n", name, type, help);
}

void single(std::string& out, const char* name, const char* type, const char* help, uint64_t value) {
  describe(out, name, type, help);
  fmt::format_to(std::back_inserter(out), "{} {}\n", name, value);
}

}  // namespace

Metrics::Route& Metrics::route(const char* name) {
  for (size_t i = 0; i + 1 < routes_.size(); ++i) {
    const char* here = routes_[i].name.load(std::memory_order_acquire);
    if (here == nullptr && routes_[i].name.compare_exchange_strong(here, name)) return routes_[i];
    if (here == name || std::strcmp(here, name) == 0) return routes_[i];
  }
  routes_.back().name.store("more", kRelaxed);
  return routes_.back();
}

void Metrics::request(const char* name, int status, double seconds) {
  Route& r = route(name);
  r.statuses[static_cast<size_t>(std::clamp(status, 100, 599) - 100)].fetch_add(1, kRelaxed);
  r.buckets[static_cast<size_t>(std::ranges::lower_bound(kBuckets, seconds) - kBuckets.begin())].fetch_add(1, kRelaxed);
  r.nanoseconds.fetch_add(static_cast<uint64_t>(std::max(0.0, seconds) * 1e9), kRelaxed);
}

std::string metrics_text(const Metrics& m, const ServerState& state) {
  std::string out;
  const auto end = [&out] { return std::back_inserter(out); };
  describe(out, "teracell_build_info", "gauge", "The version of the program.");
  fmt::format_to(end(), "teracell_build_info{{version=\"{}\"}} 1\n", state.version);
  describe(out, "teracell_requests_total", "counter", "Requests that were answered.");
  for (const Metrics::Route& r : m.routes())
    if (const char* name = r.name.load())
      for (size_t s = 0; s < r.statuses.size(); ++s)
        if (const uint64_t n = r.statuses[s].load(kRelaxed))
          fmt::format_to(end(), "teracell_requests_total{{route=\"{}\",status=\"{}\"}} {}\n", name, s + 100, n);
  describe(out, "teracell_request_duration_seconds", "histogram", "Time from the end of a request's head to the end of its answer.");
  for (const Metrics::Route& r : m.routes())
    if (const char* name = r.name.load()) {
      uint64_t sum = 0;
      for (size_t b = 0; b < r.buckets.size(); ++b) {
        sum += r.buckets[b].load(kRelaxed);
        const std::string bound = b < Metrics::kBuckets.size() ? fmt::format("{}", Metrics::kBuckets[b]) : "+Inf";
        fmt::format_to(end(), "teracell_request_duration_seconds_bucket{{route=\"{}\",le=\"{}\"}} {}\n", name, bound, sum);
      }
      fmt::format_to(end(), "teracell_request_duration_seconds_sum{{route=\"{}\"}} {}\n", name,
                     static_cast<double>(r.nanoseconds.load(kRelaxed)) * 1e-9);
      fmt::format_to(end(), "teracell_request_duration_seconds_count{{route=\"{}\"}} {}\n", name, sum);
    }
  const auto caches = [&](const char* name, const char* type, const char* help, auto CacheCounts::*value) {
    describe(out, name, type, help);
    for (const CacheState& c : state.caches) fmt::format_to(end(), "{}{{cache=\"{}\"}} {}\n", name, c.name, c.counts.*value);
  };
  caches("teracell_cache_bytes", "gauge", "Memory that the cache holds.", &CacheCounts::bytes);
  caches("teracell_cache_limit_bytes", "gauge", "Memory that the cache may hold.", &CacheCounts::limit);
  caches("teracell_cache_hits_total", "counter", "Entries that were asked for and in the cache.", &CacheCounts::hits);
  caches("teracell_cache_misses_total", "counter", "Entries that were asked for and had to be made.", &CacheCounts::misses);
  single(out, "teracell_grids", "gauge", "Grids that are served.", state.grids);
  single(out, "teracell_reads_total", "counter", "Reads of chunks and index pages from the files.", state.reads);
  single(out, "teracell_read_bytes_total", "counter", "Bytes that these reads returned.", state.read_bytes);
  single(out, "teracell_damaged_total", "counter", "Requests that failed because a file is damaged or can't be read.", state.damaged);
  single(out, "teracell_log_dropped_total", "counter", "Lines of the log that nobody read in time or that could not be written.", state.log_dropped);
  single(out, "teracell_connections", "gauge", "Open connections.", m.connections.load(kRelaxed));
  single(out, "teracell_connections_accepted_total", "counter", "Connections that were accepted.", m.accepted.load(kRelaxed));
  describe(out, "teracell_connections_dropped_total", "counter",
           "Connections that the server closed: there were too many, or the client took too long.");
  const std::pair<const char*, const std::atomic<uint64_t>*> drops[] = {
      {"full", &m.refused}, {"idle", &m.idle}, {"slow_request", &m.slow_requests}, {"slow_answer", &m.slow_answers}};
  for (const auto& [why, n] : drops) fmt::format_to(end(), "teracell_connections_dropped_total{{reason=\"{}\"}} {}\n", why, n->load(kRelaxed));
  single(out, "teracell_waiting_requests", "gauge", "Requests that a thread is answering or that wait for one.", m.waiting.load(kRelaxed));
  single(out, "teracell_held_bytes", "gauge", "Bytes of answers that clients have yet to take.", m.held_bytes.load(kRelaxed));
  single(out, "teracell_cut_answers_total", "counter", "Answers that ended early because their next part could not be made.", m.cut.load(kRelaxed));
  single(out, "teracell_overloaded_total", "counter", "Requests that got status 503 because too many requests waited or too many bytes were held.",
         m.overloaded.load(kRelaxed));
  single(out, "process_resident_memory_bytes", "gauge", "Resident memory.", state.resident_bytes);
  return out;
}

Handler with_operations(Handler inner, const Metrics& metrics, std::function<ServerState()> state) {
  const auto operation = [&metrics, state = std::move(state)](const Request& request) -> std::optional<Response> {
    const std::string_view path = path_of(request.target);
    const bool health = path == "/healthz";
    if (!health && path != "/metrics") return std::nullopt;
    Response r;
    r.route = health ? "healthz" : "metrics";
    r.content_type = health ? "application/json" : "text/plain; version=0.0.4";
    r.body = body_of(health ? R"({"status":"ok"})" : metrics_text(metrics, state()));
    r.cache_control = "no-store";
    return r;
  };
  return {[operation, at_once = std::move(inner.at_once)](const Request& request) {
            std::optional<Response> r = operation(request);
            return r ? r : at_once(request);
          },
          std::move(inner.handle), std::move(inner.is_open), std::move(inner.cost_of)};
}

}  // namespace teracell::server
