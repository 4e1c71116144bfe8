// HTTP/1.1 over TCP. The listener accepts connections (connection.hpp) and hands each to an io thread (loop.hpp), which owns it
// until it is closed. These three files alone know a socket. Requests that take long go to a pool of other threads, so that
// health checks and cached tiles are answered while uncached ones are made.
#pragma once
#include <memory>
#include <string>

#include "server/http/access_log.hpp"
#include "server/http/options.hpp"
#include "server/operations/metrics.hpp"
#include "server/service/handler.hpp"

namespace teracell::server {

class Listener {
 public:
  // Binds: from here on the system accepts connections; they are answered once run() is called. `metrics` and `log` must
  // outlive the listener. Throws IoError.
  Listener(ListenerOptions options, Handler handler, Metrics& metrics, AccessLog& log);
  // Waits for requests that are being made.
  ~Listener();

  std::string url() const;  // with the actual port and a slash at the end
  bool loopback() const;    // whether only this machine can reach it

  // Serves until stop() or a signal. From then on nothing more is accepted and idle connections are closed. Returns true when
  // all requests under way are answered, false when the drain timeout comes first.
  bool run();
  void stop();  // from any thread
  void use_token(const std::string& token);  // instead of the last one, for requests from now on; from any thread

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace teracell::server
