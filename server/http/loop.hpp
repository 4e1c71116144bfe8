// An io thread with its connections, from accept to close: they need no lock. With what all loops share, and the Asio types
// of the listener's files.
#pragma once
#include <algorithm>
#include <chrono>
#include <ctime>
#include <list>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <boost/asio.hpp>

#include "server/http/listener.hpp"

namespace teracell {

namespace asio = boost::asio;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;

// The plain executor: the polymorphic one costs an allocation here and there.
using Executor = asio::io_context::executor_type;
using Socket = asio::basic_stream_socket<tcp, Executor>;
using Timer = asio::basic_waitable_timer<Clock, asio::wait_traits<Clock>, Executor>;
template <class T>
using Awaitable = asio::awaitable<T, Executor>;
constexpr asio::use_awaitable_t<Executor> kAwait;

std::string authority(const tcp::endpoint& endpoint);  // "127.0.0.1:8080", "[::1]:8080"

// Runs until there is nothing left to do. What a handler throws (memory ran out) has cost what that handler was about; the
// thread goes on.
void run_all(asio::io_context& io) noexcept;

// Threads that run what takes long. Not asio::thread_pool: there an exception ends the process.
class Pool {
 public:
  explicit Pool(int threads);
  Executor executor() { return io_.get_executor(); }
  void join();  // when all that was given is done

 private:
  asio::io_context io_;
  asio::executor_work_guard<Executor> work_;
  std::vector<std::jthread> threads_;  // last: they use the others
};

// What the connections of all loops share.
struct Shared {
  Shared(ListenerOptions o, Handler h, Metrics& m, AccessLog& l)
      : options(std::move(o)), handler(std::move(h)), metrics(m), log(l), pool(std::max(1, options.threads)) {}
  const ListenerOptions options;
  const Handler handler;
  Metrics& metrics;
  AccessLog& log;
  Pool pool;
};

class Connection;

// All but io, adopt() and what is posted is for its own thread.
struct Loop {
  explicit Loop(Shared& s) : shared(s), timer(io) {}
  ~Loop() { stopping = false; }  // connections that go with it must not touch the timer

  void adopt(Socket socket, Counted open);  // serves it; any thread. `open` counts the connection
  Awaitable<void> sweep();                  // until it was stopped and the last connection is gone
  void stop();
  std::string_view date();  // for the Date field

  Shared& shared;
  std::list<Connection*> connections;
  bool stopping = false, drained = true;
  Clock::time_point drain_end = Clock::time_point::max();
  std::time_t date_second = 0;
  std::string date_text;
  asio::io_context io{1};  // below what its handlers use
  Timer timer;
};

}  // namespace teracell
