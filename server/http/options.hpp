// What a listener is told: where to listen, how much to accept, how long to wait.
#pragma once
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace teracell::server {

struct ListenerOptions {
  using Milliseconds = std::chrono::milliseconds;
  std::string host = "127.0.0.1";
  uint16_t port = 8080;           // 0: any that is free
  int threads = 1;                // io threads, and as many in the pool, but at least two
  std::string base_path;          // see is_base_path()
  std::string token;              // empty: none is asked for; see also Listener::use_token()
  // See host.hpp. An empty list means loopback alone when the listener is bound to loopback and asks for no token, else any.
  std::vector<std::string> allowed_hosts, allowed_origins;
  std::string host_hint;          // ends the message that refuses a host: how to allow it
  // The peers that name a client by X-Forwarded-For. Their own connections are not limited as those of a client.
  std::vector<std::string> trusted_proxies;
  // The limits per client hold while at least half of what there is for all is taken.
  // A connection that comes when all are taken, or all of its client's share, takes the place of the one among these that has been idle longest.
  // If none is idle, its request gets status 503; beyond so many of these at once, a connection is closed as soon as it is accepted.
  // What gives way is closed a moment later, and may get a request before, so there are never more than kMostBeyond connections too many.
  static constexpr uint64_t kMostRefused = 16, kMostBeyond = 8;
  size_t max_connections = 1024, max_connections_per_client = 256;
  // Requests in the pool, running or queued; further ones get status 503.
  size_t max_waiting = 1024, max_waiting_per_client = 256;
  // Bytes of answers that clients have yet to take; an answer that several clients take counts for each of them. Requests that need
  // the pool get status 503 when their client has a quarter of this to take and all have half, or any of it while all have all. So a client
  // that takes what it asks for is served even then, up to half as much again. Each thread of the pool may exceed this by one answer.
  size_t max_held = size_t{128} << 20;
  Milliseconds request_timeout{10'000};  // for a request, from its first byte; for the first one from the connection's beginning
  Milliseconds idle_timeout{60'000};     // between requests
  Milliseconds answer_timeout{30'000};   // for taking as much of an answer as kSlowest bytes per second would give, again and again
  Milliseconds work_timeout{60'000};     // for making an answer; looked at between chunks
  Milliseconds drain_timeout{10'000};    // for requests under way when the listener stops
  bool stop_on_signals = false;          // SIGINT and SIGTERM; the second one has its usual effect
  std::function<bool()> on_hangup = {};  // called at SIGHUP by the pool; false: stop. Not set: SIGHUP has its usual effect
  static constexpr size_t kSlowest = size_t{32} << 10;
};

}  // namespace teracell::server
