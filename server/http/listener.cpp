#include "server/http/listener.hpp"

#include <cerrno>
#include <csignal>
#include <optional>

#include <fmt/format.h>

#include "server/http/connection.hpp"

namespace teracell::server {
namespace {

using Acceptor = asio::basic_socket_acceptor<tcp, Executor>;

constexpr auto kPause = std::chrono::milliseconds(250);  // after a connection could not be accepted

// Has the client's connection that has been idle longest closed, if one is idle. That happens a moment later.
bool make_room_of(const std::shared_ptr<Client>& client) {
  const std::lock_guard lock(client->mutex);
  if (client->giving_way >= client->idle.size()) return false;
  Loop& loop = **std::next(client->idle.begin(), static_cast<ptrdiff_t>(client->giving_way));
  asio::post(loop.io, [&loop, client] {
    loop.drop_idlest(client.get());
    const std::lock_guard again(client->mutex);
    --client->giving_way;
  });
  ++client->giving_way;  // only now: post() may have no memory
  return true;
}

tcp::endpoint resolved(asio::io_context& io, const std::string& host, uint16_t port) {
  error_code error;
  const auto found = tcp::resolver(io).resolve(host, std::to_string(port), tcp::resolver::passive | tcp::resolver::numeric_service, error);
  if (error || found.empty()) throw IoError(fmt::format("can't listen at {}: expected an address of this machine: {}", host, error.message()));
  return *found.begin();
}

const char* advice(const error_code& error) {
  if (error == asio::error::address_in_use) return ": stop the other server, or choose another port";
  if (error == asio::error::access_denied) return ": choose a port from 1024 on";
  return error.value() == EADDRNOTAVAIL ? ": expected an address of this machine" : "";
}

}  // namespace

struct Listener::State {
  State(ListenerOptions options, Handler handler, Metrics& metrics, AccessLog& log) : shared(std::move(options), std::move(handler), metrics, log) {
    try {
      for (int i = 0; i < std::max(1, shared.options.threads); ++i) loops.push_back(std::make_unique<Loop>(shared));
      acceptor.emplace(loops[0]->io);
      signals.emplace(loops[0]->io);
    } catch (const boost::system::system_error& e) {
      throw IoError(fmt::format("can't start io thread {}: {}", loops.size() + 1, e.what()));
    }
  }
  // First the pool: its work uses connections, which belong to the loops.
  ~State() { shared.pool.join(); }

  void bind();
  void await_signal();
  Awaitable<void> accept();
  Awaitable<void> accept_one(Loop& loop);
  bool make_room();
  void stop();

  Shared shared;
  std::vector<std::unique_ptr<Loop>> loops;
  std::optional<Acceptor> acceptor;
  std::optional<asio::signal_set> signals;
  tcp::endpoint local;
};

Listener::Listener(ListenerOptions options, Handler handler, Metrics& metrics, AccessLog& log)
    : state_(std::make_unique<State>(std::move(options), std::move(handler), metrics, log)) {
  state_->bind();
  if (state_->shared.options.stop_on_signals) state_->signals->add(SIGINT), state_->signals->add(SIGTERM);
  if (state_->shared.options.on_hangup) state_->signals->add(SIGHUP);
  state_->await_signal();
}

Listener::~Listener() = default;

std::string Listener::url() const { return fmt::format("http://{}{}/", authority(state_->local), state_->shared.options.base_path); }

bool Listener::loopback() const { return state_->local.address().is_loopback(); }

bool Listener::run() {
  State& s = *state_;
  asio::co_spawn(s.loops[0]->io, s.accept(), asio::detached);
  for (const auto& loop : s.loops) asio::co_spawn(loop->io, loop->sweep(), asio::detached);
  {
    std::vector<std::jthread> others;
    try {
      for (size_t i = 1; i < s.loops.size(); ++i) others.emplace_back([&loop = *s.loops[i]] { run_all(loop.io); });
    } catch (const std::system_error& e) {
      for (const auto& loop : s.loops) loop->io.stop();  // the others must not go on
      throw IoError(fmt::format("can't start io thread {} of {}: {}", others.size() + 2, s.loops.size(), e.code().message()));
    }
    run_all(s.loops[0]->io);
  }
  return std::ranges::all_of(s.loops, [](const auto& loop) { return loop->drained; });
}

void Listener::stop() { state_->stop(); }

void Listener::use_token(const std::string& token) {
  for (const auto& loop : state_->loops) asio::post(loop->io, [&l = *loop, token] { l.token = token; });
}

void Listener::State::bind() {
  const ListenerOptions& o = shared.options;
  const tcp::endpoint wanted = resolved(loops[0]->io, o.host, o.port);
  error_code error;
  acceptor->open(wanted.protocol(), error);
  if (!error) acceptor->set_option(tcp::acceptor::reuse_address(true), error);
  if (!error) acceptor->bind(wanted, error);
  if (!error) acceptor->listen(asio::socket_base::max_listen_connections, error);
  if (error) throw IoError(fmt::format("can't listen at {} port {}: {}{}", o.host, o.port, error.message(), advice(error)));
  local = acceptor->local_endpoint();
  if (local.address().is_loopback() && o.token.empty()) return;
  for (std::vector<std::string>* allowed : {&shared.options.allowed_hosts, &shared.options.allowed_origins})
    if (allowed->empty()) allowed->emplace_back("*");
}

void Listener::State::await_signal() {
  signals->async_wait([this](const error_code& error, int number) {
    if (error) return;
    if (number != SIGHUP) return stop();
    shared.pool.post(this, Cost::kCheap, [this] {
      if (!shared.options.on_hangup()) stop();
    });
    await_signal();
  });
}

// Deals the connections out to the loops in turn.
Awaitable<void> Listener::State::accept() {
  for (size_t turn = 0; acceptor->is_open(); turn = (turn + 1) % loops.size()) try {
      co_await accept_one(*loops[turn]);
    } catch (const std::exception&) {  // no memory for this one
    }
}

Awaitable<void> Listener::State::accept_one(Loop& loop) {
  Metrics& m = shared.metrics;
  Socket socket(loop.io);
  error_code error;
  co_await acceptor->async_accept(socket, asio::redirect_error(kAwait, error));
  if (error == asio::error::operation_aborted) co_return;
  if (error) {  // no descriptor is left, or the client has gone already
    Timer pause(loops[0]->io, kPause);
    co_await pause.async_wait(asio::redirect_error(kAwait, error));
    co_return;
  }
  m.accepted.fetch_add(1);
  const std::string address = address_name(socket.remote_endpoint(error).address());
  const ListenerOptions& o = shared.options;
  const bool proxy = std::ranges::find(o.trusted_proxies, address) != o.trusted_proxies.end();
  const std::shared_ptr<Client> client = shared.clients.at(address);
  const bool share_is_taken = !proxy && client->connections >= o.max_connections_per_client && m.connections >= o.max_connections / 2;
  const bool room = m.connections < o.max_connections + ListenerOptions::kMostBeyond &&
                    (share_is_taken ? make_room_of(client) : m.connections < o.max_connections || make_room());
  if (!room) m.refused.fetch_add(1);
  if (room) serve_connection(loop, std::move(socket), {client, proxy, false, Counted(m.connections), Counted(client->connections)});
  else if (shared.refused < ListenerOptions::kMostRefused)
    serve_connection(loop, std::move(socket), {client, proxy, true, Counted(shared.refused), {}});
}

// Returns whether some connection was idle. It is closed a moment later.
bool Listener::State::make_room() {
  const auto most = std::ranges::max_element(loops, {}, [](const auto& loop) { return loop->idle.load(); });
  if ((*most)->idle == 0) return false;
  asio::post((*most)->io, [&loop = **most] { loop.drop_idlest(); });
  return true;
}

void Listener::State::stop() {
  asio::post(loops[0]->io, [this] {
    error_code ignored;
    acceptor->close(ignored);
    signals->clear(ignored);  // the next signal has its usual effect
    signals->cancel(ignored);
    for (const auto& loop : loops) asio::post(loop->io, [&l = *loop] { l.stop(); });
  });
}

}  // namespace teracell::server
