#include "server/http/connection.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>

#include <fmt/format.h>

#include "server/http/host.hpp"
#include "server/service/target.hpp"

namespace teracell::server {
namespace {

constexpr std::chrono::milliseconds kLinger{2000};  // time for a client to read why it was refused
constexpr size_t kMostLingering = size_t{1} << 20;
constexpr size_t kSmall = size_t{64} << 10;  // answers from memory up to this size are given to clients that hold their share, too
constexpr size_t kFirstBuffer = size_t{2} << 10;  // bytes; grows up to the longest head

constexpr auto kLook = std::chrono::milliseconds(20);  // between two looks whether a client still waits for an answer

Awaitable<void> serve(std::unique_ptr<Connection> connection) { co_await connection->serve(); }

// The exception that is being handled, as a response.
Response failure() {
  try {
    throw;
  } catch (const HttpError& e) {
    return error_response(e.status, e.code, e.what());
  } catch (const TooDear& e) {
    return error_response(503, "too_dear", e.what());
  } catch (const Unwanted& e) {
    return error_response(499, "gone", e.what());
  } catch (const std::bad_alloc&) {
    return try_again("out_of_memory", "the server is out of memory: try again later");
  } catch (const std::exception& e) {
    return error_response(500, "internal", e.what());
  } catch (...) {
    return error_response(500, "internal", "unknown");
  }
}

}  // namespace

void serve_connection(Loop& loop, Socket socket, Peer peer) {
  asio::post(loop.io, [&loop, s = std::move(socket), p = std::move(peer)]() mutable {
    asio::co_spawn(loop.io, serve(std::make_unique<Connection>(loop, std::move(s), std::move(p))), asio::detached);
  });
}

Connection::Connection(Loop& loop, Socket socket, Peer peer)
    : peer_(std::move(peer)), loop_(loop), shared_(loop.shared), socket_(std::move(socket)), requester_(peer_.client), buffer_(kFirstBuffer) {
  error_code ignored;
  socket_.set_option(tcp::no_delay(true), ignored);
  socket_.non_blocking(true, ignored);
  client_ = socket_.remote_endpoint(ignored).address().to_string(ignored);
  local_ = authority(socket_.local_endpoint(ignored));
  deadline_ = Clock::now() + (peer_.refused ? kLinger : shared_.options.request_timeout);
  place_ = loop.connections.insert(loop.connections.end(), this);
  enter(peer_.refused ? kReading : kIdle);
  if (loop.stopping) finish();
}

Connection::~Connection() {
  enter(kLingering);
  loop_.connections.erase(place_);
  if (loop_.stopping && loop_.connections.empty()) loop_.timer.cancel();
}

Awaitable<void> Connection::serve() {
  error_code error;
  while (keep_) {
    parser_.emplace(head_);
    HeadParser::Progress progress;
    while ((progress = parse()) == HeadParser::kMore) {
      if (state_ == kIdle && (parser_->begun() || begin_ < end_)) {
        enter(kReading);
        deadline_ = Clock::now() + shared_.options.request_timeout;
      }
      end_ += co_await socket_.async_read_some(space(), asio::redirect_error(kAwait, error));
      if (error) co_return;
    }
    const auto start = Clock::now();
    deadline_ = Clock::time_point::max();
    if (progress == HeadParser::kWhole) {
      keep_ = parser_->keep_alive() && !loop_.stopping && !peer_.refused;
      if (peer_.refused) response_ = overloaded("all connections that this server, or one client of it, may have are in use");
      else co_await make();
    } else {
      keep_ = false;
      response_ = std::move(parser_->refusal());
    }
    const bool taken = co_await send();
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - start).count();
    shared_.metrics.request(response_.route, response_.status, seconds);
    shared_.log.write({client_, head_.method, head_.target, response_.status, body_sent_, seconds * 1e3, response_.route, cut_});
    if (cut_) shared_.metrics.cut.fetch_add(1);
    if (!taken) co_return;
    response_ = {};  // lets go of the body, which may be in the cache
    held_ = {}, held_by_client_ = {};
    requester_ = peer_.client;
    enter(kIdle);
    deadline_ = now + shared_.options.idle_timeout;
    if (loop_.stopping) finish();
  }
  co_await linger();
}

HeadParser::Progress Connection::parse() {
  std::string_view bytes(buffer_.data() + begin_, end_ - begin_);
  const HeadParser::Progress progress = parser_->put(bytes);
  begin_ = end_ - bytes.size();
  return progress;
}

asio::mutable_buffer Connection::space() {
  if (begin_ == end_) begin_ = end_ = 0;
  if (end_ == buffer_.size() && begin_ > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_, begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(std::min(2 * buffer_.size(), HeadParser::kMaxHead));
  return asio::buffer(buffer_.data() + end_, buffer_.size() - end_);
}

Awaitable<void> Connection::make() {
  enter(kMaking);
  std::optional<Response> here;
  try {
    here = answer_here();
  } catch (...) {
    here = failure();
  }
  if (const std::string client = peer_.proxy ? last_forwarded(head_.forwarded_for) : ""; !client.empty()) requester_ = shared_.clients.at(client);
  if (here) {
    const bool large = here->body && here->body->size() > kSmall;
    response_ = large && requester_->held_bytes >= shared_.options.max_held / 4 ? too_much_held() : std::move(*here);
    co_return;
  }
  const Counted waiting(shared_.metrics.waiting), waiting_of_client(requester_->waiting);
  if (waits_too_much()) {
    response_ = overloaded(fmt::format("{} other requests are being answered or wait, {} of them from this client", shared_.metrics.waiting - 1,
                                       requester_->waiting - 1));
  } else if (holds_too_much()) {
    response_ = too_much_held();
  } else {
    co_await in_pool(shared_.handler.cost_of ? shared_.handler.cost_of(request_) : Cost::kCheap, [this] { make_in_pool(); });
  }
  if (loop_.stopping) keep_ = false;
}

// Work ends early when the client has closed the connection: browsers do so with tiles that are no longer shown. Throws when there is
// no memory, even for saying so.
Awaitable<void> Connection::in_pool(Cost cost, std::function<void()> work) {
  Timer ended(loop_.io, Clock::time_point::max());
  bool done = false;
  shared_.pool.post(requester_.get(), cost, [&] {
    try {
      const auto began = Clock::now();
      auto looked = began - kLook;
      const Wanted wanted([&, this] { check_wanted(began, looked); });
      work();
      done = true;
    } catch (...) {
    }
    asio::post(loop_.io, [&ended] { ended.cancel(); });  // runs when this coroutine waits
  });
  error_code ignored;
  co_await ended.async_wait(asio::redirect_error(kAwait, ignored));
  if (!done) throw std::bad_alloc();
}

// A refusal of other hosts, methods or paths or of missing tokens, or what the handler answers at once. None when the pool must make
// the answer.
std::optional<Response> Connection::answer_here() {
  const ListenerOptions& o = shared_.options;
  if (!head_.host.empty() && !allows_host(o.allowed_hosts, head_.host))
    return error_response(421, "misdirected",
                          fmt::format("Host: expected localhost, or another name of this server, found {}{}", clipped(head_.host), o.host_hint));
  if (head_.method == "OPTIONS") return Response{.status = 204, .route = "options"};
  if (head_.method != "GET" && head_.method != "HEAD") return error_response(405, "method_not_allowed", "expected GET, HEAD or OPTIONS");
  fill_request(request_, head_, o.base_path, local_);
  const bool inside = take_off_base(request_.target, o.base_path);
  const std::string_view path = path_of(request_.target);
  if (path.empty() || (!inside && path == "/")) return Response{.status = 302, .cache_control = "no-cache", .location = request_.prefix + "/"};
  if (!inside) return error_response(404, "not_found", fmt::format("expected a path below {}/", o.base_path));
  const auto open = [&] { return path == "/healthz" || (shared_.handler.is_open && shared_.handler.is_open(path)); };
  if (!loop_.token.empty() && !bears_token(head_.authorization, loop_.token) && !open()) {
    Response r = error_response(401, "unauthorized", "expected the field Authorization: Bearer TOKEN");
    r.route = "unauthorized";
    return r;
  }
  return shared_.handler.at_once(request_);
}

void Connection::make_in_pool() try {
  Wanted::stop_if_not();
  // The limit may have been reached while the request waited.
  response_ = holds_too_much() ? too_much_held() : shared_.handler.handle(request_);
  hold();
} catch (...) {
  response_ = failure();
  if (response_.status == 499) keep_ = false;
}

void Connection::check_wanted(Clock::time_point began, Clock::time_point& looked) const {
  const auto now = Clock::now();
  if (now - looked < kLook) return;
  looked = now;
  if (client_has_gone()) throw Unwanted("the client closed the connection");
  const auto most = shared_.options.work_timeout;
  if (now - began > most)
    throw TooDear(fmt::format("the answer takes more than {:g} s of work: ask for a smaller region or a coarser level", most.count() / 1000.));
}

bool Connection::client_has_gone() const {
  pollfd p{const_cast<Socket&>(socket_).native_handle(), POLLRDHUP, 0};  // also set behind bytes that are not read yet
  return !finishing_ && poll(&p, 1, 0) > 0;
}

bool Connection::waits_too_much() const {
  const ListenerOptions& o = shared_.options;
  const uint64_t all = shared_.metrics.waiting;
  return (all > o.max_waiting && requester_->waiting > 1) || (requester_->waiting > o.max_waiting_per_client && all > o.max_waiting / 2);
}

bool Connection::holds_too_much() const {
  const uint64_t all = shared_.metrics.held_bytes, of_client = requester_->held_bytes, most = shared_.options.max_held;
  return (of_client >= most / 4 && all >= most / 2) || (all >= most && of_client > 0) || all >= most + most / 2;
}

void Connection::hold() {
  const size_t bytes = (response_.body ? response_.body->size() : 0) + (response_.rest ? response_.rest->memory() : 0);
  held_ = Counted(shared_.metrics.held_bytes, bytes);
  held_by_client_ = Counted(requester_->held_bytes, bytes);
}

Response Connection::too_much_held() const {
  return overloaded(fmt::format("clients have yet to take {} bytes of answers, and this one {} of them", shared_.metrics.held_bytes.load(),
                                requester_->held_bytes.load()));
}

Response Connection::overloaded(const std::string& message) const {
  shared_.metrics.overloaded.fetch_add(1);
  return try_again("overloaded", message + ": try again in a second");
}

// If a socket is closed while input is unread, the system discards output that the client has not taken yet, such as the
// response that says what was wrong with the request.
Awaitable<void> Connection::linger() {
  error_code error;
  socket_.shutdown(tcp::socket::shutdown_send, error);
  if (loop_.stopping) receive_no_more();
  enter(kLingering);
  deadline_ = Clock::now() + kLinger;
  for (size_t read = 0; !error && read < kMostLingering;)
    read += co_await socket_.async_read_some(asio::buffer(buffer_), asio::redirect_error(kAwait, error));
}

void Connection::finish() {
  if (state_ != kMaking && state_ != kWriting) receive_no_more();
}

// Bytes that the system has received already are still read.
void Connection::receive_no_more() {
  error_code ignored;
  finishing_ = true;
  socket_.shutdown(tcp::socket::shutdown_receive, ignored);
}

void Connection::drop_if_late(Clock::time_point now) {
  if (now < deadline_) return;
  Metrics& m = shared_.metrics;
  if (state_ == kIdle) m.idle.fetch_add(1);
  else if (state_ == kReading) m.slow_requests.fetch_add(1);
  else if (state_ == kWriting) m.slow_answers.fetch_add(1);
  drop();
}

Clock::time_point Connection::idle_since() const { return state_ == kIdle ? entered_ : Clock::time_point::max(); }

void Connection::drop() {
  error_code ignored;
  socket_.close(ignored);
  if (state_ == kIdle) enter(kLingering);  // nobody else is to drop it
}

void Connection::enter(State state) {
  Client& client = *peer_.client;
  if (state_ == kIdle && state != kIdle) {
    loop_.idle.fetch_sub(1);
    const std::lock_guard lock(client.mutex);
    busy_.splice(busy_.end(), client.idle, idle_);
  } else if (state == kIdle && state_ != kIdle) {
    loop_.idle.fetch_add(1);
    const std::lock_guard lock(client.mutex);
    client.idle.splice(client.idle.end(), busy_);
  }
  state_ = state;
  entered_ = Clock::now();
}

}  // namespace teracell::server
