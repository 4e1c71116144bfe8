#include "server/listener.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <list>
#include <optional>
#include <thread>
#include <vector>

#include <boost/asio.hpp>
#include <boost/beast/http/basic_parser.hpp>
#include <fmt/format.h>

#include "server/wire.hpp"

namespace teracell {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;
using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

// The plain executor: the polymorphic one costs an allocation here and there.
using Executor = asio::io_context::executor_type;
using Socket = asio::basic_stream_socket<tcp, Executor>;
using Acceptor = asio::basic_socket_acceptor<tcp, Executor>;
using Timer = asio::basic_waitable_timer<Clock, asio::wait_traits<Clock>, Executor>;
template <class T>
using Awaitable = asio::awaitable<T, Executor>;
constexpr asio::use_awaitable_t<Executor> kAwait;

constexpr auto kTick = 250ms;              // how often deadlines are looked at
constexpr auto kLinger = 2s;               // for a client to see why it was refused
constexpr size_t kMostLingering = size_t{1} << 20;
constexpr size_t kFirstBuffer = size_t{2} << 10;  // of an idle connection; grows to what a request may have

std::string authority(const tcp::endpoint& e) {
  const std::string address = e.address().to_string();
  return e.address().is_v6() ? fmt::format("[{}]:{}", address, e.port()) : fmt::format("{}:{}", address, e.port());
}

// Fills a Head. Beast checks the grammar and keeps nothing.
class HeadParser : public http::basic_parser<true> {
 public:
  explicit HeadParser(Head& head) : head_(head) {
    header_limit(ListenerOptions::kMaxHead);
    body_limit(ListenerOptions::kMaxBody);
  }
  bool got_target() const { return got_target_; }

 private:
  using View = boost::beast::string_view;
  void on_request_impl(http::verb, View method, View target, int version, error_code&) override {
    head_.method.assign(method.data(), method.size());
    head_.target.assign(target.data(), target.size());
    head_.http11 = version == 11;
    got_target_ = true;
  }
  void on_field_impl(http::field name, View name_text, View value, error_code&) override {
    switch (name) {
      case http::field::host: ++head_.hosts; return set(head_.host, value);
      case http::field::if_none_match: return add(head_.if_none_match, value);
      case http::field::accept_encoding: return add(head_.accept_encoding, value);
      case http::field::authorization: return set(head_.authorization, value);
      case http::field::transfer_encoding: head_.has_transfer_encoding = true; return;
      default: break;
    }
    if (name_text.size() < 16 || (name_text[0] | 0x20) != 'x') return;
    if (boost::beast::iequals(name_text, "x-forwarded-proto")) set(head_.forwarded_proto, value);
    else if (boost::beast::iequals(name_text, "x-forwarded-host")) set(head_.forwarded_host, value);
    else if (boost::beast::iequals(name_text, "x-forwarded-prefix")) set(head_.forwarded_prefix, value);
  }
  static void set(std::string& out, View value) { out.assign(value.data(), value.size()); }
  static void add(std::string& list, View value) {
    if (!list.empty()) list += ", ";
    list.append(value.data(), value.size());
  }
  void on_header_impl(error_code&) override {}
  void on_body_init_impl(const boost::optional<uint64_t>&, error_code&) override {}
  size_t on_body_impl(View body, error_code&) override { return body.size(); }
  void on_chunk_header_impl(uint64_t, View, error_code&) override {}
  size_t on_chunk_body_impl(uint64_t, View body, error_code&) override { return body.size(); }
  void on_finish_impl(error_code&) override {}
  void on_response_impl(int, View, int, error_code&) override {}

  Head& head_;
  bool got_target_ = false;
};

class Connection;

// What the connections of all io threads share.
struct Shared {
  Shared(ListenerOptions o, Handler h, Metrics& m, AccessLog& l)
      : options(std::move(o)), handler(std::move(h)), metrics(m), log(l), pool(static_cast<size_t>(std::max(1, options.threads))) {}
  const ListenerOptions options;
  const Handler handler;
  Metrics& metrics;
  AccessLog& log;
  asio::thread_pool pool;
};

// An io thread. All but io.run() and post() is for that thread alone.
struct Loop {
  explicit Loop(Shared& s) : shared(s), timer(io) {}
  ~Loop() { stopping = false; }  // connections that go with it must not touch the timer
  Shared& shared;
  std::list<Connection*> connections;
  bool stopping = false, drained = true;
  Clock::time_point drain_end = Clock::time_point::max();
  std::time_t date_second = 0;
  std::string date_text;
  asio::io_context io{1};  // below what its handlers use
  Timer timer;

  std::string_view date();
  Awaitable<void> sweep();
  void stop();
};

class Connection {
 public:
  enum State { kIdle, kReading, kMaking, kWriting, kLingering };

  Connection(Loop& loop, Socket socket) : loop_(loop), shared_(loop.shared), socket_(std::move(socket)), buffer_(kFirstBuffer) {
    error_code ignored;
    socket_.set_option(tcp::no_delay(true), ignored);
    socket_.non_blocking(true, ignored);
    const auto peer = socket_.remote_endpoint(ignored);
    client_ = peer.address().to_string(ignored);
    const auto local = socket_.local_endpoint(ignored);
    local_ = authority(local);
    deadline_ = Clock::now() + shared_.options.request_timeout;
    place_ = loop.connections.insert(loop.connections.end(), this);
    if (loop.stopping) finish();
  }
  ~Connection() {
    loop_.connections.erase(place_);
    shared_.metrics.connections.fetch_sub(1);
    if (loop_.stopping && loop_.connections.empty()) loop_.timer.cancel();
  }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  Awaitable<void> serve();
  State state() const { return state_; }
  void close() {
    error_code ignored;
    socket_.close(ignored);
  }
  // What the system has of a request is still read; then comes the end.
  void finish() {
    error_code ignored;
    finishing_ = true;
    socket_.shutdown(tcp::socket::shutdown_receive, ignored);
  }
  void drop_if_late(Clock::time_point now);

 private:
  enum Progress { kMore, kWhole, kRefused };
  Progress parse();
  Progress refuse(int status, const char* code, const std::string& message);
  std::optional<Response> answer_here();
  Awaitable<void> make();
  asio::awaitable<void> make_in_pool();
  Response handled() const;
  Awaitable<bool> send();
  Awaitable<void> linger();
  asio::mutable_buffer space();

  Loop& loop_;
  Shared& shared_;
  Socket socket_;
  std::list<Connection*>::iterator place_;
  State state_ = kReading;
  std::atomic<bool> finishing_ = false;  // the end of what is received is our own doing
  Clock::time_point deadline_;
  std::string client_, local_;

  std::vector<char> buffer_;
  size_t begin_ = 0, end_ = 0;  // what was read and not yet used
  std::optional<HeadParser> parser_;
  Head head_;
  size_t head_bytes_ = 0;       // of the head, used so far
  uint64_t skip_ = 0;           // bytes of a body that nobody wants
  Request request_;
  Response response_;
  std::string out_;
  bool keep_ = true;
};

// Of the parser's mishaps only size and version deserve their own words.
Connection::Progress Connection::refuse(int status, const char* code, const std::string& message) {
  response_ = error_response(status, code, message);
  keep_ = false;
  return kRefused;
}

Connection::Progress Connection::parse() {
  if (!parser_) {
    head_.clear();
    head_bytes_ = 0;
    parser_.emplace(head_);
  }
  if (!parser_->is_header_done()) {
    if (begin_ == end_) return kMore;
    error_code error;
    const size_t used = parser_->put(asio::const_buffer(buffer_.data() + begin_, end_ - begin_), error);
    begin_ += used;
    head_bytes_ += used;
    if (error == http::error::body_limit)
      return refuse(413, "too_large", fmt::format("expected a request without a body, found more than {} bytes", ListenerOptions::kMaxBody));
    if (error == http::error::bad_version) return refuse(505, "bad_version", "expected HTTP/1.0 or HTTP/1.1");
    if (error == http::error::header_limit || (error == http::error::need_more && head_bytes_ + end_ - begin_ >= ListenerOptions::kMaxHead)) {
      const std::string message = fmt::format("expected at most {} bytes of request line and header fields, found more", ListenerOptions::kMaxHead);
      return parser_->got_target() ? refuse(431, "headers_too_large", message) : refuse(414, "target_too_long", message);
    }
    if (error == http::error::need_more) return kMore;
    if (error) return refuse(400, "bad_request", "malformed request: " + error.message());
    if (head_.has_transfer_encoding) return refuse(413, "too_large", "expected a request without a body, found Transfer-Encoding");
    if (head_.hosts > 1 || (head_.http11 && head_.hosts == 0)) return refuse(400, "bad_request", fmt::format("expected one Host field, found {}", head_.hosts));
    skip_ = parser_->content_length_remaining().value_or(0);
  }
  const size_t skipped = std::min<uint64_t>(skip_, end_ - begin_);
  begin_ += skipped;
  skip_ -= skipped;
  if (skip_ > 0) return kMore;
  keep_ = parser_->keep_alive() && !loop_.stopping;
  return kWhole;
}

asio::mutable_buffer Connection::space() {
  if (begin_ == end_) begin_ = end_ = 0;
  if (end_ == buffer_.size() && begin_ > 0) {
    std::copy(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), buffer_.begin() + static_cast<std::ptrdiff_t>(end_), buffer_.begin());
    end_ -= begin_, begin_ = 0;
  }
  if (end_ == buffer_.size()) buffer_.resize(std::min(2 * buffer_.size(), ListenerOptions::kMaxHead));
  return asio::buffer(buffer_.data() + end_, buffer_.size() - end_);
}

// Other methods, other paths, no token, and what the handler has at once. None: it must be made.
std::optional<Response> Connection::answer_here() {
  const ListenerOptions& o = shared_.options;
  if (head_.method == "OPTIONS") return Response{.status = 204, .route = "options"};
  if (head_.method != "GET" && head_.method != "HEAD") return error_response(405, "method_not_allowed", "expected GET, HEAD or OPTIONS");
  fill_request(request_, head_, o.base_path, local_);
  const bool inside = take_off_base(request_.target, o.base_path);
  const std::string_view path = path_of(request_.target);
  if (path.empty() || (!inside && path == "/")) return Response{.status = 302, .cache_control = "no-cache", .location = request_.prefix + "/"};
  if (!inside) return error_response(404, "not_found", fmt::format("expected a path below {}/", o.base_path));
  const auto open = [&] { return path == "/healthz" || (shared_.handler.is_open && shared_.handler.is_open(path)); };
  if (!o.token.empty() && !bears_token(head_.authorization, o.token) && !open()) {
    Response r = error_response(401, "unauthorized", "expected the field Authorization: Bearer TOKEN");
    r.route = "unauthorized";
    return r;
  }
  return shared_.handler.at_once(request_);
}

Response Connection::handled() const {
  try {
    return shared_.handler.handle(request_);
  } catch (const HttpError& e) {
    return error_response(e.status, e.code, e.what());
  } catch (const std::exception& e) {
    return error_response(500, "internal", e.what());
  }
}

// On a thread of the pool. Nobody waits for an answer on a connection that was closed: browsers give up tiles so.
asio::awaitable<void> Connection::make_in_pool() {
  char byte;
  if (!finishing_ && recv(socket_.native_handle(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 0) {
    response_ = error_response(499, "gone", "the client closed the connection");
    keep_ = false;
  } else {
    response_ = handled();
  }
  co_return;
}

Awaitable<void> Connection::make() {
  state_ = kMaking;
  const ListenerOptions& o = shared_.options;
  if (std::optional<Response> here = answer_here()) {
    response_ = std::move(*here);
  } else if (shared_.metrics.waiting.fetch_add(1) >= o.max_waiting) {
    shared_.metrics.waiting.fetch_sub(1);
    shared_.metrics.overloaded.fetch_add(1);
    response_ = error_response(503, "overloaded", fmt::format("{} requests are being made or wait already: try again in a second", o.max_waiting));
  } else {
    co_await asio::co_spawn(shared_.pool.get_executor(), make_in_pool(), kAwait);
    shared_.metrics.waiting.fetch_sub(1);
    if (loop_.stopping) keep_ = false;
  }
}

// False: the client went away, or took too long.
Awaitable<bool> Connection::send() {
  static const std::string nothing;
  const bool with_body = response_.body && head_.method != "HEAD" && response_.status != 204 && response_.status != 304;
  const std::string& body = with_body ? *response_.body : nothing;
  out_.clear();
  append_head(out_, response_, {keep_, head_.http11, loop_.date()});
  std::array<asio::const_buffer, 2> rest{asio::buffer(out_), asio::buffer(body)};
  error_code error;
  size_t sent = socket_.write_some(rest, error);
  const size_t all = out_.size() + body.size();
  if (error == asio::error::would_block) error = {};
  if (error) co_return false;
  if (sent < all) {
    state_ = kWriting;
    deadline_ = Clock::now() + shared_.options.answer_timeout + std::chrono::seconds(all / ListenerOptions::kSlowest);
    while (sent < all) {
      rest = {asio::buffer(out_) + sent, asio::buffer(body) + (std::max(sent, out_.size()) - out_.size())};
      sent += co_await socket_.async_write_some(rest, asio::redirect_error(kAwait, error));
      if (error) co_return false;
    }
  }
  co_return true;
}

// Closing with unread bytes would throw away what the client has not taken yet, such as the answer that says what was
// wrong with them.
Awaitable<void> Connection::linger() {
  error_code error;
  socket_.shutdown(tcp::socket::shutdown_send, error);
  if (loop_.stopping) finish();
  state_ = kLingering;
  deadline_ = Clock::now() + kLinger;
  for (size_t read = 0; !error && read < kMostLingering;)
    read += co_await socket_.async_read_some(asio::buffer(buffer_), asio::redirect_error(kAwait, error));
}

Awaitable<void> Connection::serve() {
  error_code error;
  while (keep_) {
    Progress progress = parse();
    for (; progress == kMore; progress = parse()) {
      if (state_ == kIdle && (head_bytes_ > 0 || begin_ < end_)) {
        state_ = kReading;
        deadline_ = Clock::now() + shared_.options.request_timeout;
      }
      end_ += co_await socket_.async_read_some(space(), asio::redirect_error(kAwait, error));
      if (error) co_return;
    }
    const auto start = Clock::now();
    deadline_ = Clock::time_point::max();
    if (progress == kWhole) co_await make();
    const bool taken = co_await send();
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - start).count();
    shared_.metrics.request(response_.route, response_.status, seconds);
    shared_.log.write({client_, head_.method, head_.target, response_.status, response_.body ? response_.body->size() : 0, seconds * 1e3, response_.route});
    if (!taken) co_return;
    response_ = {};  // its body is the cache's
    parser_.reset();
    state_ = kIdle;
    deadline_ = now + shared_.options.idle_timeout;
  }
  co_await linger();
}

void Connection::drop_if_late(Clock::time_point now) {
  if (now < deadline_) return;
  Metrics& m = shared_.metrics;
  if (state_ == kIdle) m.idle.fetch_add(1);
  else if (state_ == kReading) (end_ == 0 && !head_bytes_ ? m.idle : m.slow_requests).fetch_add(1);
  else if (state_ == kWriting) m.slow_answers.fetch_add(1);
  close();
}

std::string_view Loop::date() {
  if (const std::time_t now = std::time(nullptr); now != date_second) {
    date_second = now;
    date_text = http_date(now);
  }
  return date_text;
}

// Deadlines are looked at four times a second: a timer a connection would cost more than its requests.
Awaitable<void> Loop::sweep() {
  while (!stopping || !connections.empty()) {
    error_code ignored;
    timer.expires_after(kTick);
    co_await timer.async_wait(asio::redirect_error(kAwait, ignored));
    const auto now = Clock::now();
    for (Connection* c : connections) c->drop_if_late(now);
    if (now >= drain_end) {
      drained = false;
      io.stop();
    }
    shared.log.flush();
  }
}

void Loop::stop() {
  if (stopping) return;
  stopping = true;
  drain_end = Clock::now() + shared.options.drain_timeout;
  for (Connection* c : connections)
    if (c->state() != Connection::kMaking && c->state() != Connection::kWriting) c->finish();
  if (connections.empty()) timer.cancel();
}

tcp::endpoint resolved(asio::io_context& io, const std::string& host, uint16_t port) {
  error_code error;
  const auto found = tcp::resolver(io).resolve(host, std::to_string(port), tcp::resolver::passive | tcp::resolver::numeric_service, error);
  if (error || found.empty()) throw IoError(fmt::format("--host {}: expected an address of this machine, found: {}", host, error.message()));
  return *found.begin();
}

}  // namespace

struct Listener::State {
  State(ListenerOptions options, Handler handler, Metrics& metrics, AccessLog& log)
      : shared(std::move(options), std::move(handler), metrics, log) {
    for (int i = 0; i < std::max(1, shared.options.threads); ++i) loops.push_back(std::make_unique<Loop>(shared));
    acceptor.emplace(loops[0]->io);
    signals.emplace(loops[0]->io);
  }
  // The pool's work uses connections, which belong to the loops.
  ~State() { shared.pool.join(); }

  void bind();
  Awaitable<void> accept();
  void stop();

  Shared shared;
  std::vector<std::unique_ptr<Loop>> loops;
  std::optional<Acceptor> acceptor;
  std::optional<asio::signal_set> signals;
  tcp::endpoint local;
};

void Listener::State::bind() {
  const ListenerOptions& o = shared.options;
  const tcp::endpoint wanted = resolved(loops[0]->io, o.host, o.port);
  error_code error;
  acceptor->open(wanted.protocol(), error);
  if (!error) acceptor->set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor->bind(wanted, error);
  if (!error) acceptor->listen(asio::socket_base::max_listen_connections, error);
  if (error)
    throw IoError(fmt::format("can't listen at {} port {}: {}{}", o.host, o.port, error.message(),
                              error == asio::error::address_in_use ? ": stop the other server, or choose another --port" : ""));
  local = acceptor->local_endpoint();
}

// Deals the connections out to the loops in turn.
Awaitable<void> Listener::State::accept() {
  Metrics& m = shared.metrics;
  for (size_t turn = 0; acceptor->is_open(); turn = (turn + 1) % loops.size()) {
    Loop& loop = *loops[turn];
    Socket socket(loop.io);
    error_code error;
    co_await acceptor->async_accept(socket, asio::redirect_error(kAwait, error));
    if (error == asio::error::operation_aborted) co_return;
    if (error) {  // no descriptors left, or the client is gone again
      Timer pause(loops[0]->io, kTick);
      co_await pause.async_wait(asio::redirect_error(kAwait, error));
      continue;
    }
    m.accepted.fetch_add(1);
    if (m.connections.load() >= shared.options.max_connections) {
      m.refused.fetch_add(1);
      continue;
    }
    m.connections.fetch_add(1);
    asio::post(loop.io, [&loop, s = std::move(socket)]() mutable {
      auto connection = std::make_unique<Connection>(loop, std::move(s));
      asio::co_spawn(loop.io, [](std::unique_ptr<Connection> c) -> Awaitable<void> { co_await c->serve(); }(std::move(connection)), asio::detached);
    });
  }
}

void Listener::State::stop() {
  asio::post(loops[0]->io, [this] {
    error_code ignored;
    acceptor->close(ignored);
    signals->clear(ignored);  // the next one has its usual effect
    for (const auto& loop : loops) asio::post(loop->io, [&l = *loop] { l.stop(); });
  });
}

Listener::Listener(ListenerOptions options, Handler handler, Metrics& metrics, AccessLog& log)
    : state_(std::make_unique<State>(std::move(options), std::move(handler), metrics, log)) {
  state_->bind();
  if (state_->shared.options.stop_on_signals) {
    state_->signals->add(SIGINT);
    state_->signals->add(SIGTERM);
    state_->signals->async_wait([s = state_.get()](const error_code& error, int) {
      if (!error) s->stop();
    });
  }
}

Listener::~Listener() = default;

std::string Listener::url() const {
  return fmt::format("http://{}{}/", authority(state_->local), state_->shared.options.base_path);
}

bool Listener::loopback() const { return state_->local.address().is_loopback(); }

bool Listener::run() {
  State& s = *state_;
  asio::co_spawn(s.loops[0]->io, s.accept(), asio::detached);
  for (const auto& loop : s.loops) asio::co_spawn(loop->io, loop->sweep(), asio::detached);
  {
    std::vector<std::jthread> threads;
    for (size_t i = 1; i < s.loops.size(); ++i) threads.emplace_back([&loop = *s.loops[i]] { loop.io.run(); });
    s.loops[0]->io.run();
  }
  s.shared.log.flush();
  return std::ranges::all_of(s.loops, [](const auto& loop) { return loop->drained; });
}

void Listener::stop() { state_->stop(); }

}  // namespace teracell
