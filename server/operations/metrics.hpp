// What the server counts, and the two documents about it: /healthz and /metrics (Prometheus text, version 0.0.4).
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "server/service/handler.hpp"
#include "server/service/service.hpp"

namespace teracell::server {

// Adds to a counter for as long as it lives.
class Counted {
 public:
  Counted() = default;
  explicit Counted(std::atomic<uint64_t>& counter, uint64_t n = 1) : counter_(&counter), n_(n) { counter.fetch_add(n); }
  Counted(Counted&& other) noexcept : counter_(std::exchange(other.counter_, nullptr)), n_(other.n_) {}
  Counted& operator=(Counted&& other) noexcept {
    std::swap(counter_, other.counter_);
    std::swap(n_, other.n_);
    return *this;
  }
  ~Counted() {
    if (counter_) counter_->fetch_sub(n_);
  }
  explicit operator bool() const { return counter_ != nullptr; }

 private:
  std::atomic<uint64_t>* counter_ = nullptr;
  uint64_t n_ = 0;
};

// Threads share it; nothing in it locks.
class Metrics {
 public:
  // Upper bounds of the buckets for the durations of requests, in seconds. One further bucket has no bound.
  static constexpr std::array<double, 12> kBuckets = {0.0001, 0.0003, 0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30};

  // `route` has static storage. The first 31 different ones are counted apart, further ones together.
  void request(const char* route, int status, double seconds);

  std::atomic<uint64_t> connections{0};     // open
  std::atomic<uint64_t> accepted{0};        // connections ever
  std::atomic<uint64_t> refused{0};         // connections beyond max_connections or their client's share, closed or answered 503
  std::atomic<uint64_t> idle{0};            // connections closed because no request came
  std::atomic<uint64_t> slow_requests{0};   // connections closed because a request did not end in time
  std::atomic<uint64_t> slow_answers{0};    // connections closed because the client did not take its answer in time
  std::atomic<uint64_t> waiting{0};         // requests in the pool, queued or running
  std::atomic<uint64_t> held_bytes{0};      // of answers that clients have yet to take
  std::atomic<uint64_t> cut{0};             // answers that ended early because a part could not be made
  std::atomic<uint64_t> overloaded{0};      // requests answered 503 because one of these two was too high

  struct Route {
    std::atomic<const char*> name{nullptr};
    std::array<std::atomic<uint64_t>, 500> statuses{};  // 100 to 599
    std::array<std::atomic<uint64_t>, kBuckets.size() + 1> buckets{};
    std::atomic<uint64_t> nanoseconds{0};
  };
  const std::array<Route, 32>& routes() const { return routes_; }

 private:
  Route& route(const char* name);
  std::array<Route, 32> routes_;  // filled from the front; the last one takes all further routes
};

// What others count: asked for when the document is made.
struct ServerState {
  std::vector<CacheState> caches;
  uint64_t grids = 0, reads = 0, read_bytes = 0, damaged = 0, log_dropped = 0;
  uint64_t resident_bytes = 0;
  std::string version;
};
std::string metrics_text(const Metrics& metrics, const ServerState& state);

// `inner`, behind a handler for /healthz and /metrics.
Handler with_operations(Handler inner, const Metrics& metrics, std::function<ServerState()> state);

}  // namespace teracell::server
