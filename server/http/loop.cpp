#include "server/http/loop.hpp"

#include <fmt/format.h>

#include "server/http/connection.hpp"
#include "server/wire.hpp"

namespace teracell {
namespace {

constexpr auto kTick = std::chrono::milliseconds(250);  // how often deadlines are looked at

Awaitable<void> serve(std::unique_ptr<Connection> connection) { co_await connection->serve(); }

}  // namespace

std::string authority(const tcp::endpoint& e) {
  const std::string address = e.address().to_string();
  return e.address().is_v6() ? fmt::format("[{}]:{}", address, e.port()) : fmt::format("{}:{}", address, e.port());
}

void run_all(asio::io_context& io) noexcept {
  for (;;) try {
      io.run();
      return;
    } catch (...) {
    }
}

Pool::Pool(int threads) : io_(threads), work_(io_.get_executor()) {
  try {
    for (int i = 0; i < threads; ++i) threads_.emplace_back([this] { run_all(io_); });
  } catch (...) {  // a thread that can't be had: those that are there must not wait for work
    io_.stop();
    throw;
  }
}

void Pool::join() {
  work_.reset();
  threads_.clear();
}

void Loop::adopt(Socket socket, Counted open) {
  asio::post(io, [this, s = std::move(socket), o = std::move(open)]() mutable {
    asio::co_spawn(io, serve(std::make_unique<Connection>(*this, std::move(s), std::move(o))), asio::detached);
  });
}

// Deadlines are looked at four times a second: a timer a connection would cost more than its requests.
Awaitable<void> Loop::sweep() {
  while (!stopping || !connections.empty()) {
    try {
      error_code ignored;
      timer.expires_after(kTick);
      co_await timer.async_wait(asio::redirect_error(kAwait, ignored));
    } catch (const std::bad_alloc&) {  // deadlines hold all the same
    }
    const auto now = Clock::now();
    for (Connection* c : connections) c->drop_if_late(now);
    if (now >= drain_end) {
      drained = false;
      io.stop();
    }
  }
}

void Loop::stop() {
  if (stopping) return;
  stopping = true;
  drain_end = Clock::now() + shared.options.drain_timeout;
  for (Connection* c : connections) c->finish();
  if (connections.empty()) timer.cancel();
}

std::string_view Loop::date() {
  if (const std::time_t now = std::time(nullptr); now != date_second) {
    date_text = http_date(now);
    date_second = now;
  }
  return date_text;
}

}  // namespace teracell
