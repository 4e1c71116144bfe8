// HTTP/1.1 over TCP. This one accepts; each io thread (loop.hpp) owns its connections (connection.hpp) from then to the end,
// and no other file knows a socket. Requests that take long go to a pool of other threads, so that health and warm tiles are
// answered while cold ones are made.
#pragma once
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "server/http/access_log.hpp"
#include "server/handler.hpp"
#include "server/metrics.hpp"

namespace teracell {

struct ListenerOptions {
  using Milliseconds = std::chrono::milliseconds;
  std::string host = "127.0.0.1";
  uint16_t port = 8080;           // 0: any that is free
  int threads = 1;                // of each kind
  std::string base_path;          // see is_base_path()
  std::string token;              // empty: none is asked for
  size_t max_connections = 1024;  // more are closed at once
  size_t max_waiting = 256;       // requests in the pool; more are answered 503
  // Bytes of answers that clients are taking, what several take counted for each: beyond, what must be made is answered 503.
  // Passed by at most an answer a thread.
  size_t max_held = size_t{256} << 20;
  Milliseconds request_timeout{10'000};  // for a request, from its first byte or from the connection's beginning
  Milliseconds idle_timeout{60'000};     // between requests
  Milliseconds answer_timeout{60'000};   // for taking an answer, and a second more for each kSlowest bytes of it
  Milliseconds drain_timeout{10'000};    // for requests under way when it stops
  bool stop_on_signals = false;   // SIGINT and SIGTERM; the second one has its usual effect
  static constexpr size_t kSlowest = size_t{32} << 10;
};

class Listener {
 public:
  // Binds: connections are accepted by the system from here on, and answered once run() is called. `metrics` and `log` must
  // outlive it. Throws IoError.
  Listener(ListenerOptions options, Handler handler, Metrics& metrics, AccessLog& log);
  // Waits for requests that are being made.
  ~Listener();

  std::string url() const;  // with the real port and a slash at the end
  bool loopback() const;    // whether only this machine can reach it

  // Serves until stop() or a signal: then nothing more is accepted, idle connections are closed, and it returns when what
  // was under way is answered: true; or false when the drain timeout came first.
  bool run();
  void stop();  // from any thread

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace teracell
