#include "server/http/loop.hpp"

#include <fmt/format.h>

#include "server/http/wire.hpp"

namespace teracell::server {
namespace {

constexpr auto kTick = std::chrono::milliseconds(250);  // between two looks at the deadlines

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

// One timer for all deadlines: a timer per connection would cost more than its requests.
Awaitable<void> Loop::sweep() {
  while (!stopping || !connections.empty()) {
    try {
      error_code ignored;
      timer.expires_after(kTick);
      co_await timer.async_wait(asio::redirect_error(kAwait, ignored));
    } catch (const std::bad_alloc&) {  // without the pause: deadlines are checked all the same
    }
    const auto now = Clock::now();
    for (LoopMember* c : connections) c->drop_if_late(now);
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
  for (LoopMember* c : connections) c->finish();
  if (connections.empty()) timer.cancel();
}

void Loop::drop_idlest(const Client* of) {
  LoopMember* longest = nullptr;
  for (LoopMember* c : connections)
    if ((!of || &c->client() == of) && (!longest || c->idle_since() < longest->idle_since())) longest = c;
  if (longest && longest->idle_since() != Clock::time_point::max()) longest->drop();
}

std::string_view Loop::date() {
  if (const std::time_t now = std::time(nullptr); now != date_second) {
    date_text = http_date(now);
    date_second = now;
  }
  return date_text;
}

}  // namespace teracell::server
