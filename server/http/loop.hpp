// An io thread and the connections that live on it from accept to close, so that they need no lock. Also the pool and what else
// all loops share, and the Asio types that these files use.
#pragma once
#include <algorithm>
#include <chrono>
#include <ctime>
#include <list>
#include <string>
#include <string_view>
#include <utility>

#include <boost/asio.hpp>

#include "server/http/access_log.hpp"
#include "server/http/clients.hpp"
#include "server/http/options.hpp"
#include "server/http/pool.hpp"
#include "server/operations/metrics.hpp"
#include "server/service/handler.hpp"

namespace teracell::server {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

// The plain executor: the polymorphic one allocates memory for some operations.
using Executor = asio::io_context::executor_type;
using Socket = asio::basic_stream_socket<tcp, Executor>;
using Timer = asio::basic_waitable_timer<Clock, asio::wait_traits<Clock>, Executor>;
template <class T>
using Awaitable = asio::awaitable<T, Executor>;
constexpr asio::use_awaitable_t<Executor> kAwait;

std::string authority(const tcp::endpoint& endpoint);  // "127.0.0.1:8080", "[::1]:8080"

// Runs until there is nothing left to do. An exception that a handler throws (when memory runs out) ends that handler alone.
void run_all(asio::io_context& io) noexcept;

// What the connections of all loops share.
struct Shared {
  Shared(ListenerOptions o, Handler h, Metrics& m, AccessLog& l)
      : options(std::move(o)), handler(std::move(h)), metrics(m), log(l), pool(std::max(2, options.threads)) {}
  ListenerOptions options;  // unchanged once the listener is bound
  const Handler handler;
  Metrics& metrics;
  AccessLog& log;
  std::atomic<uint64_t> refused{0};  // connections beyond a limit, which are told so
  Clients clients;
  Pool pool;
};

// A connection as its loop sees it.
class LoopMember {
 public:
  virtual void finish() = 0;  // takes no further request; what is under way is still answered
  virtual void drop_if_late(Clock::time_point now) = 0;
  // Since when it waits for a request; the end of time while it has one.
  virtual Clock::time_point idle_since() const = 0;
  virtual const Client& client() const = 0;  // whose it is
  virtual void drop() = 0;

 protected:
  ~LoopMember() = default;
};

// All but `io` and what is posted to it is for the loop's own thread.
struct Loop {
  explicit Loop(Shared& s) : shared(s), token(s.options.token), timer(io) {}
  ~Loop() { stopping = false; }  // connections destroyed with `io` must not touch the timer

  Awaitable<void> sweep();  // until stop() was called and the last connection is gone
  void stop();
  void drop_idlest(const Client* of = nullptr);  // closes the connection that has been idle longest, of a client or of all, if any is idle
  std::string_view date();  // for the Date field

  Shared& shared;
  std::string token;  // that clients must send; empty: none
  std::list<LoopMember*> connections;
  std::atomic<size_t> idle = 0;  // connections that wait for a request; any thread may read it
  bool stopping = false, drained = true;
  Clock::time_point drain_end = Clock::time_point::max();
  std::time_t date_second = 0;
  std::string date_text;
  asio::io_context io{1};  // after the members that its handlers use: they die with it
  Timer timer;
};

}  // namespace teracell::server
