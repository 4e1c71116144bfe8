// How a connection sends an answer: at once, or in parts that the pool makes one after the other as the client takes them.
#include <algorithm>
#include <array>
#include <iterator>

#include <fmt/format.h>

#include "server/http/connection.hpp"
#include "server/http/host.hpp"
#include "store/base/wanted.hpp"

namespace teracell::server {

// Returns false when the answer is not complete: the client went away or took too long, or a part could not be made.
Awaitable<bool> Connection::send() {
  if (response_.rest && !head_.http11) keep_ = false;
  out_.clear();
  const auto& origins = shared_.options.allowed_origins;
  append_head(out_, response_, {keep_, head_.http11, loop_.date(), allowed_origin(origins, head_.origin)});
  if (head_.method == "HEAD" || response_.status == 204 || response_.status == 304) response_.body = nullptr, response_.rest = nullptr;
  chunked_ = response_.rest && head_.http11;
  sent_ = body_sent_ = goal_ = 0;
  cut_ = false;
  bool good = co_await write();
  while (good && response_.rest) good = co_await next_part() && co_await write();
  if (cut_) {  // a reset: without chunks, the plain end of the connection would look like that of the answer
    error_code ignored;
    socket_.set_option(asio::socket_base::linger(true, 0), ignored);
    socket_.close(ignored);
  }
  co_return good;
}

// Has the pool make the next part. Returns false when it could not.
Awaitable<bool> Connection::next_part() {
  enter(kMaking);
  deadline_ = Clock::time_point::max();
  const auto began = Clock::now();
  const Counted waiting(shared_.metrics.waiting), waiting_of_client(requester_->waiting);
  co_await in_pool(Cost::kDear, [this] { make_part(); });
  due_ += Clock::now() - began;  // this was not the client's time
  out_.clear();
  co_return response_.body != nullptr;
}

// Puts the next part of the response in place of the last one. The client has part of an answer with a good status by now, so an error
// can only cut it.
void Connection::make_part() try {
  response_.body = nullptr;
  Wanted::stop_if_not();
  std::string part;
  bool more = true;
  while (more && part.empty()) more = response_.rest->append(part);
  response_.body = body_of(std::move(part));
  if (!more) response_.rest = nullptr;
  hold();
} catch (const TooDear&) {
  cut_ = true;
} catch (const Unwanted&) {  // the client has gone
} catch (...) {
  cut_ = true;
}

// Sends `out_` and the body. Returns false when the client went away or took too long.
Awaitable<bool> Connection::write() {
  static const std::string nothing;
  const std::string& body = response_.body ? *response_.body : nothing;
  std::string_view end;
  if (chunked_) {
    if (!body.empty()) fmt::format_to(std::back_inserter(out_), "{:x}\r\n", body.size());
    end = response_.rest ? "\r\n" : "\r\n0\r\n\r\n";
    if (body.empty()) end.remove_prefix(2);
  }
  std::array<asio::const_buffer, 3> rest{asio::buffer(out_), asio::buffer(body), asio::buffer(end)};
  const size_t before = sent_;
  const auto count = [&](size_t n) {
    sent_ += n;
    for (asio::const_buffer& b : rest) {
      const size_t of_this = std::min(n, b.size());
      b += of_this, n -= of_this;
    }
  };
  error_code error;
  count(socket_.write_some(rest, error));
  if (error == asio::error::would_block) error = {};
  if (asio::buffer_size(rest) > 0 && !error) {
    enter(kWriting);
    if (!held_) hold();
    const auto timeout = shared_.options.answer_timeout;
    const size_t least = ListenerOptions::kSlowest * static_cast<size_t>(timeout.count()) / 1000;  // bytes to be taken in this time
    while (asio::buffer_size(rest) > 0 && !error) {
      if (sent_ >= goal_) {
        goal_ = sent_ + least;
        due_ = Clock::now() + timeout;
      }
      deadline_ = due_;
      count(co_await socket_.async_write_some(rest, asio::redirect_error(kAwait, error)));
    }
  }
  body_sent_ += std::min(body.size(), std::max(sent_ - before, out_.size()) - out_.size());
  co_return !error;
}

}  // namespace teracell::server
