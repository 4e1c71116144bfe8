// The listener over real sockets, with a simple handler.
#include "server/http/listener.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <unistd.h>

#include <condition_variable>
#include <csignal>
#include <future>
#include <mutex>
#include <thread>

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include "store/wanted.hpp"
#include "tests/support/sanitized.hpp"
#include "tests/support/stored.hpp"

using namespace teracell;
using namespace std::chrono_literals;

namespace {

// A plain client. It waits for anything at most ten seconds.
class Client {
 public:
  // `from` is the last number of the address that it comes from, 127.0.0.from.
  explicit Client(const std::string& url, uint32_t from = 1) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in a{};
    a.sin_family = AF_INET;
    a.sin_addr.s_addr = htonl(INADDR_LOOPBACK - 1 + from);
    bind(fd_, reinterpret_cast<sockaddr*>(&a), sizeof a);
    a.sin_port = htons(static_cast<uint16_t>(std::stoi(url.substr(url.find(':', 7) + 1))));
    a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    open_ = connect(fd_, reinterpret_cast<sockaddr*>(&a), sizeof a) == 0;
  }
  ~Client() { close(fd_); }
  Client(const Client&) = delete;

  bool open() const { return open_; }
  bool send(const std::string& text) { return ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size()); }
  bool get(const std::string& target, const std::string& fields = "") { return send("GET " + target + " HTTP/1.1\r\nHost: h\r\n" + fields + "\r\n"); }

  struct Answer {
    int status = 0;  // 0: there was no answer
    std::string head, body;
    bool has(const std::string& line) const { return head.find("\r\n" + line + "\r\n") != std::string::npos; }
  };
  Answer answer(bool with_body = true) {
    Answer a;
    size_t end;
    while ((end = in_.find("\r\n\r\n")) == std::string::npos)
      if (!more()) return a;
    a.head = in_.substr(0, end + 2);
    in_.erase(0, end + 4);
    const size_t length = a.head.find("Content-Length: ");
    const size_t bytes = with_body && length != std::string::npos ? std::stoul(a.head.substr(length + 16)) : 0;
    while (in_.size() < bytes)
      if (!more()) return a;
    a.body = in_.substr(0, bytes);
    in_.erase(0, bytes);
    a.status = std::stoi(a.head.substr(9));
    return a;
  }
  // Whether the server closes the connection without sending another byte.
  bool closed() { return in_.empty() && !more() && in_.empty() && ended_; }
  int descriptor() const { return fd_; }

 private:
  bool more() {
    char bytes[65536];
    pollfd p{fd_, POLLIN, 0};
    if (poll(&p, 1, 10000) != 1) return false;
    const ssize_t n = recv(fd_, bytes, sizeof bytes, 0);
    if (n <= 0) return ended_ = true, false;
    in_.append(bytes, static_cast<size_t>(n));
    return true;
  }
  int fd_;
  bool open_ = false, ended_ = false;
  std::string in_;
};

// A door at which requests for /held wait.
class Door {
 public:
  void wait() {
    std::unique_lock lock(mutex_);
    ++waiting_;
    changed_.notify_all();
    changed_.wait(lock, [&] { return open_; });
  }
  void open() {
    std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  void wait_for(int n) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return waiting_ >= n; });
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  bool open_ = false;
  int waiting_ = 0;
};

// A listener that runs while the fixture lives. Answers contain what was asked for.
struct Fixture {
  Door door;
  Metrics metrics;
  AccessLog log;
  std::unique_ptr<Listener> listener;
  std::future<bool> result;

  explicit Fixture(ListenerOptions o = {}, int log_descriptor = -1) : log(log_descriptor < 0 ? LogFormat::kNone : LogFormat::kText, log_descriptor) {
    o.port = 0;
    if (o.threads == 1) o.threads = 2;
    for (std::vector<std::string>* allowed : {&o.allowed_hosts, &o.allowed_origins})
      if (allowed->empty()) *allowed = {"*"};
    const auto answer = [](const Request& r) {
      Response a{.content_type = "text/plain", .route = "echo"};
      a.body = body_of(r.target == "/big" ? std::string(64 << 20, 'b')
                                          : fmt::format("{} {} {}{} {} {}", r.method, r.target, r.origin, r.prefix, r.if_none_match, r.accepts_gzip));
      return a;
    };
    const auto throw_if_asked = [](const std::string& target) {
      if (target.ends_with("/thrown")) throw std::runtime_error("thrown");
      if (target.ends_with("/anything")) throw 7;
    };
    Handler h{[=](const Request& r) {
                if (r.target.starts_with("/held") || r.target.starts_with("/cold")) return std::optional<Response>();
                throw_if_asked(r.target);
                return std::optional(answer(r));
              },
              [=, this](const Request& r) {
                if (r.target.starts_with("/held")) door.wait();
                while (r.target == "/cold/endless") {
                  Wanted::stop_if_not();
                  std::this_thread::sleep_for(1ms);
                }
                throw_if_asked(r.target);
                return answer(r);
              },
              {},
              [](const Request& r) { return r.target.ends_with("dear"); }};
    Handler all = with_operations(std::move(h), metrics, [] { return ServerState{}; });
    all.is_open = [](std::string_view path) { return path == "/open"; };
    listener = std::make_unique<Listener>(o, all, metrics, log);
    result = std::async(std::launch::async, [this] { return listener->run(); });
  }
  ~Fixture() {
    door.open();
    listener->stop();
  }
  bool stop() {
    listener->stop();
    return result.get();
  }
  Client client(uint32_t from = 1) const { return Client(listener->url(), from); }
  Client::Answer get(const std::string& target, const std::string& fields = "", uint32_t from = 1) const {
    Client c = client(from);
    c.get(target, fields);
    return c.answer();
  }
};

int status_of(const Fixture& f, const std::string& text) {
  Client c = f.client();
  c.send(text);
  return c.answer().status;
}

// Waits until a condition holds, at most ten seconds.
bool soon(const std::function<bool()>& holds) {
  for (int i = 0; i < 1000; ++i, std::this_thread::sleep_for(10ms))
    if (holds()) return true;
  return false;
}

}  // namespace

TEST_CASE("a connection serves one request after the other, also when they arrive together or in pieces", "[server][listener]") {
  Fixture f;
  Client c = f.client();
  c.get("/one");
  CHECK(c.answer().body == "GET /one http://h  false");
  c.get("/cold", "Accept-Encoding: br, gzip\r\nIf-None-Match: \"a\"\r\nIf-None-Match: \"b\"\r\n");
  CHECK(c.answer().body == "GET /cold http://h \"a\", \"b\" true");
  c.send(
      "GET /1 HTTP/1.1\r\nHost: h\r\n\r\nGET /held HTTP/1.1\r\nHost: h\r\n\r\nGET /2 HTTP/1.1\r\nHost: h\r\nContent-Length: 3\r\n\r\nabcGET /3 HT");
  CHECK(c.answer().body == "GET /1 http://h  false");
  f.door.open();
  CHECK(c.answer().body == "GET /held http://h  false");
  CHECK(c.answer().body == "GET /2 http://h  false");
  c.send("TP/1.1\r\nHos");
  c.send("t: h\r\nX: " + std::string(12000, 'x') + "\r\n\r");
  c.send("\n");
  CHECK(c.answer().body == "GET /3 http://h  false");
  CHECK(f.metrics.accepted == 1);
}

TEST_CASE("HEAD gives the length without a body, OPTIONS what is allowed", "[server][listener]") {
  Fixture f;
  Client c = f.client();
  c.send("HEAD /a HTTP/1.1\r\nHost: h\r\n\r\n");
  const auto head = c.answer(false);
  CHECK(head.status == 200);
  CHECK(head.has(fmt::format("Content-Length: {}", std::string("HEAD /a http://h  false").size())));
  c.send("OPTIONS /a HTTP/1.1\r\nHost: h\r\nAccess-Control-Request-Headers: range\r\n\r\n");
  const auto options = c.answer();
  CHECK(options.status == 204);
  CHECK(options.has("Access-Control-Allow-Origin: *"));
  c.get("/b");
  CHECK(c.answer().body == "GET /b http://h  false");
}

TEST_CASE("requests that the listener refuses", "[server][listener]") {
  Fixture f;
  const std::string host = "Host: h\r\n";
  CHECK(status_of(f, "POST / HTTP/1.1\r\n" + host + "\r\n") == 405);
  CHECK(status_of(f, "DELETE / HTTP/1.1\r\n" + host + "Content-Length: 2\r\n\r\nab") == 405);
  CHECK(status_of(f, "BREW / HTTP/1.1\r\n" + host + "\r\n") == 405);
  CHECK(status_of(f, "GET / HTTP/1.1\r\n\r\n") == 400);
  CHECK(status_of(f, "GET / HTTP/1.1\r\n" + host + host + "\r\n") == 400);
  CHECK(status_of(f, "GET / HTTP/1.0\r\n\r\n") == 200);
  CHECK(status_of(f, "GET / HTTP/2.0\r\n" + host + "\r\n") == 505);
  CHECK(status_of(f, "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n") == 505);
  CHECK(status_of(f, "nonsense\r\n\r\n") == 400);
  CHECK(status_of(f, std::string("GET /\0 HTTP/1.1\r\n", 17) + host + "\r\n") == 400);
  CHECK(status_of(f, "GET / HTTP/1.1\r\n" + host + "a b: c\r\n\r\n") == 400);
  CHECK(status_of(f, "GET / HTTP/1.1\r\n" + host + "Content-Length: x\r\n\r\n") == 400);
  CHECK(status_of(f, "GET / HTTP/1.1\r\n" + host + "Content-Length: 3\r\nTransfer-Encoding: chunked\r\n\r\n") == 400);
  CHECK(status_of(f, "GET / HTTP/1.1\r\n" + host + "Transfer-Encoding: chunked\r\n\r\n0\r\n\r\n") == 413);
  CHECK(status_of(f, "GET / HTTP/1.1\r\n" + host + "Content-Length: 8193\r\n\r\n") == 413);
  CHECK(status_of(f, "GET / HTTP/1.1\r\n" + host + "Content-Length: 99999999999999999999999\r\n\r\n") == 400);
  CHECK(status_of(f, "GET /" + std::string(20000, 'a') + " HTTP/1.1\r\n" + host + "\r\n") == 414);
  CHECK(status_of(f, "GET / HTTP/1.1\r\n" + host + "X: " + std::string(20000, 'a') + "\r\n\r\n") == 431);
  std::string many = "GET / HTTP/1.1\r\n" + host;
  for (int i = 0; i < 3000; ++i) many += fmt::format("X{}: y\r\n", i);
  CHECK(status_of(f, many) == 431);  // even without an end
}

TEST_CASE("a client that waits for leave to send a body gets its answer at once", "[server][listener]") {
  Fixture f;
  for (const auto& [method, status] : {std::pair("GET", 200), {"POST", 405}}) {
    Client c = f.client();
    c.send(fmt::format("{} /a HTTP/1.1\r\nHost: h\r\nExpect: 100-continue\r\nContent-Length: 8\r\n\r\n", method));
    const auto a = c.answer();
    CHECK(a.status == status);
    CHECK(a.has("Connection: close"));
    CHECK(c.closed());
  }
}

TEST_CASE("a target with scheme and host means its own path and host", "[server][listener]") {
  Fixture f;
  Client c = f.client();
  c.get("http://other:1/a?b");
  CHECK(c.answer().body == "GET /a?b http://other:1  false");
  c.get("HTTP://other?x=/healthz");
  CHECK(c.answer().body == "GET /?x=/healthz http://other  false");
  CHECK(status_of(f, "OPTIONS * HTTP/1.1\r\nHost: h\r\n\r\n") == 204);
  CHECK(status_of(f, "CONNECT h:80 HTTP/1.1\r\nHost: h:80\r\n\r\n") == 405);
  CHECK(status_of(f, "GET * HTTP/1.1\r\nHost: h\r\n\r\n") == 400);
}

TEST_CASE("hosts and origins that are not allowed", "[server][listener]") {
  Fixture f({.allowed_hosts = {"grids.example"}, .allowed_origins = {"https://viewer.example"}, .host_hint = ": do this"});
  const auto status = [&](const std::string& method, const std::string& target, const std::string& host) {
    return status_of(f, fmt::format("{} {} HTTP/1.1\r\nHost: {}\r\n\r\n", method, target, host));
  };
  for (const char* target : {"/a", "/healthz", "/open"})
    for (const char* method : {"GET", "OPTIONS"}) {
      CHECK(status(method, target, "evil.example") == 421);
      CHECK(status(method, target, "127.0.0.1") < 300);
      CHECK(status(method, target, "grids.example:99") < 300);
    }
  CHECK(status("GET", "http://evil.example/a", "localhost") == 421);
  CHECK(status("GET", "http://localhost/a", "evil.example") == 200);
  CHECK(status_of(f, "GET /a HTTP/1.0\r\n\r\n") == 200);  // no browser sends this
  Client c = f.client();
  c.get("/a");
  const auto refused = c.answer();
  CHECK(refused.body.find("found 'h': do this\"") != std::string::npos);
  CHECK_FALSE(refused.has("Connection: close"));

  const auto get = [&](const std::string& fields) {
    c.send("GET /a HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n");
    return c.answer();
  };
  for (const char* allowed : {"https://viewer.example", "http://localhost:3000"})
    CHECK(get(fmt::format("Origin: {}\r\n", allowed)).has(fmt::format("Access-Control-Allow-Origin: {}", allowed)));
  for (const char* other : {"Origin: https://evil.example\r\n", "Origin: null\r\n", ""}) {
    const auto a = get(other);
    CHECK(a.status == 200);
    CHECK(a.has("Vary: Origin"));
    CHECK(a.head.find("Access-Control-Allow-Origin") == std::string::npos);
  }
}

TEST_CASE("an exception of a handler becomes an answer, and the connection stays open", "[server][listener]") {
  Fixture f;
  Client c = f.client();
  for (const char* target : {"/thrown", "/anything", "/cold/thrown", "/cold/anything"}) {
    c.get(target);
    const auto a = c.answer();
    CHECK(a.status == 500);
    CHECK_FALSE(a.has("Connection: close"));
  }
  c.get("/after");
  CHECK(c.answer().status == 200);
  CHECK(f.metrics.waiting == 0);
}

TEST_CASE("the limit for fields holds when they arrive one by one", "[server][listener]") {
  Fixture f;
  Client c = f.client();
  c.send("GET / HTTP/1.1\r\nHost: h\r\n");
  for (int i = 0; i < 400 && c.send(fmt::format("X{}: {}\r\n", i, std::string(100, 'x'))); ++i) std::this_thread::sleep_for(1ms);
  CHECK(c.answer().status == 431);
}

TEST_CASE("an empty line after a request belongs to none", "[server][listener]") {
  Fixture f;
  Client c = f.client();
  c.send("\r\nGET /1 HTTP/1.1\r\nHost: h\r\n\r\n\r\nGET /2 HTTP/1.1\r\nHost: h\r\n\r\n\r\n");
  CHECK(c.answer().body == "GET /1 http://h  false");
  CHECK(c.answer().body == "GET /2 http://h  false");
  c.get("/3");
  CHECK(c.answer().body == "GET /3 http://h  false");
}

TEST_CASE("a malformed request is refused with JSON, and its connection is closed", "[server][listener]") {
  Fixture f;
  Client c = f.client();
  c.send("GET / HTTP/1.1\r\nHost: h\r\nbad field\r\n\r\nGET /next HTTP/1.1\r\nHost: h\r\n\r\n");
  const auto a = c.answer();
  CHECK(a.body.starts_with(R"({"error":{"code":"bad_request","message":"malformed request)"));
  CHECK(a.has("Connection: close"));
  CHECK(c.closed());
}

TEST_CASE("the client decides whether the connection is kept", "[server][listener]") {
  Fixture f;
  Client closing = f.client();
  closing.get("/", "Connection: close\r\n");
  CHECK(closing.answer().has("Connection: close"));
  CHECK(closing.closed());
  Client old = f.client();
  old.send("GET / HTTP/1.0\r\n\r\n");
  CHECK(old.answer().has("Connection: close"));
  CHECK(old.closed());
  Client kept = f.client();
  kept.send("GET / HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
  CHECK(kept.answer().has("Connection: keep-alive"));
  kept.get("/");
  CHECK(kept.answer().status == 200);
}

TEST_CASE("health is answered while every thread of the pool is busy, and further requests get 503", "[server][listener][threads]") {
  Fixture f({.max_waiting = 3});
  Client held[3] = {f.client(), f.client(), f.client()};
  for (Client& c : held) c.get("/held");
  f.door.wait_for(2);  // as many as threads
  REQUIRE(soon([&] { return f.metrics.waiting == 3; }));
  CHECK(f.get("/healthz").body == R"({"status":"ok"})");
  const auto refused = f.get("/cold");
  CHECK(refused.status == 503);
  CHECK(refused.has("Retry-After: 1"));
  f.door.open();
  for (Client& c : held) CHECK(c.answer().status == 200);
  CHECK(f.get("/cold").status == 200);
  CHECK(f.metrics.waiting == 0);
}

TEST_CASE("no answer is made for a client that has gone", "[server][listener][threads]") {
  Fixture f;
  Client first = f.client(), second = f.client();
  first.get("/held");
  second.get("/held");
  f.door.wait_for(2);
  {
    Client gone = f.client();
    gone.get("/cold");
    REQUIRE(soon([&] { return f.metrics.waiting == 3; }));
  }
  f.door.open();
  REQUIRE(soon([&] { return f.metrics.waiting == 0; }));
  REQUIRE(soon([&] { return metrics_text(f.metrics, {}).find("status=\"499\"} 1") != std::string::npos; }));
}

TEST_CASE("work stops when its client goes, and when it takes too long", "[server][listener][threads]") {
  Fixture f({.work_timeout = 500ms});
  const auto refused = f.get("/cold/endless");
  CHECK(refused.status == 503);
  CHECK(refused.body.starts_with(R"({"error":{"code":"too_dear","message":"the answer takes more than 0.5 s of work)"));
  Fixture patient({.work_timeout = std::chrono::hours(1)});
  {
    Client c = patient.client();
    c.get("/cold/endless");
    REQUIRE(soon([&] { return patient.metrics.waiting == 1; }));
  }
  CHECK(soon([&] { return patient.metrics.waiting == 0; }));
}

TEST_CASE("every path needs the token except /healthz, preflights and open paths", "[server][listener]") {
  Fixture f({.token = "secret"});
  CHECK(f.get("/a").status == 401);
  CHECK(f.get("/a").has("WWW-Authenticate: Bearer realm=\"teracell\""));
  CHECK(f.get("/a", "Authorization: Bearer wrong\r\n").status == 401);
  CHECK(f.get("/a?token=secret").status == 401);
  CHECK(f.get("/open").status == 200);
  CHECK(f.get("/open?a").status == 200);
  CHECK(f.get("/open/a").status == 401);
  CHECK(f.get("/metrics").status == 401);
  CHECK(f.get("/a", "Authorization: Bearer secret\r\n").status == 200);
  CHECK(f.get("/healthz").status == 200);
  CHECK(status_of(f, "OPTIONS /a HTTP/1.1\r\nHost: h\r\n\r\n") == 204);
}

TEST_CASE("below a base path", "[server][listener]") {
  Fixture f({.base_path = "/base"});
  CHECK(f.listener->url().ends_with("/base/"));
  CHECK(f.get("/base/a?b").body == "GET /a?b http://h/base  false");
  CHECK(f.get("/base/a", "X-Forwarded-Prefix: /sub\r\nX-Forwarded-Proto: https\r\nX-Forwarded-Host: p\r\n").body ==
        "GET /a https://p/sub/base  false");
  CHECK(f.get("/base/healthz").status == 200);
  CHECK(f.get("/a").status == 404);
  CHECK(f.get("/based").status == 404);
  for (const char* root : {"/", "/base", "/base?x"}) {
    const auto a = f.get(root);
    CHECK(a.status == 302);
    CHECK(a.has("Location: /base/"));
  }
  CHECK(f.get("/", "X-Forwarded-Prefix: //evil.example\r\n").has("Location: /base/"));
}

TEST_CASE("who is idle or slow is dropped in time, and counted", "[server][listener]") {
  Fixture f({.request_timeout = 400ms, .idle_timeout = 800ms});
  Client silent = f.client(), half = f.client(), trickling = f.client(), idle = f.client();
  half.send("GET / HT");
  idle.get("/");
  CHECK(idle.answer().status == 200);
  for (int i = 0; i < 40 && trickling.send("G"); ++i) std::this_thread::sleep_for(50ms);
  CHECK(silent.closed());
  CHECK(half.closed());
  CHECK(idle.closed());
  CHECK_FALSE(trickling.answer().status == 200);
  CHECK(f.metrics.slow_requests >= 1);
  CHECK(f.metrics.idle >= 2);
  CHECK(soon([&] { return f.metrics.connections == 0; }));
}

TEST_CASE("an answer that nobody takes is given up, and counted", "[server][listener]") {
  Fixture f({.answer_timeout = 300ms});
  Client c = f.client();
  c.get("/big");
  REQUIRE(soon([&] { return f.metrics.slow_answers == 1; }));
  REQUIRE(soon([&] { return f.metrics.connections == 0; }));
  CHECK(c.answer().body.size() < 64 << 20);
}

TEST_CASE("an answer that is taken slowly is given up when it falls behind the least rate, however large it is", "[server][listener]") {
  Fixture f({.answer_timeout = 500ms});
  Client c = f.client();
  c.get("/big");
  char byte;
  const auto stopped = [&] { return f.metrics.slow_answers == 1; };
  for (int i = 0; i < 1000 && !stopped(); ++i, std::this_thread::sleep_for(10ms)) recv(c.descriptor(), &byte, 1, MSG_DONTWAIT);
  CHECK(stopped());
}

TEST_CASE("a client that holds its share of the answers leaves room for others", "[server][listener][threads]") {
  Fixture f({.max_held = 100 << 20});
  Client slow = f.client();
  slow.get("/big");
  REQUIRE(soon([&] { return f.metrics.held_bytes == 64 << 20; }));
  CHECK(f.get("/cold").status == 503);
  CHECK(f.get("/big").status == 503);  // also what is at hand
  CHECK(f.get("/warm").status == 200);
  CHECK(f.get("/cold", "", 2).status == 200);
}

TEST_CASE("a client that waits for its share of the work leaves room for others", "[server][listener][threads]") {
  Fixture f({.max_waiting = 4, .max_waiting_per_client = 2});
  Client a = f.client(), b = f.client();
  a.get("/held?dear");
  b.get("/held?dear");
  REQUIRE(soon([&] { return f.metrics.waiting == 2; }));
  const auto refused = f.get("/cold");
  CHECK(refused.status == 503);
  CHECK(refused.body.find("2 of them from this client") != std::string::npos);
  CHECK(f.get("/cold", "", 2).status == 200);  // the two that wait are dear, so they have one thread
}

TEST_CASE("a trusted proxy names the clients, others can't", "[server][listener][threads]") {
  Fixture f({.trusted_proxies = {"127.0.0.1"}, .max_connections = 4, .max_connections_per_client = 1, .max_waiting = 2, .max_waiting_per_client = 1});
  Client a = f.client();
  a.get("/held?dear", "X-Forwarded-For: 6.6.6.6, 10.0.0.1\r\n");
  REQUIRE(soon([&] { return f.metrics.waiting == 1; }));
  CHECK(f.get("/cold", "X-Forwarded-For: 10.0.0.1\r\n").status == 503);
  CHECK(f.get("/cold", "X-Forwarded-For: 10.0.0.2\r\n").status == 200);
  Client b = f.client(2);
  b.get("/held?dear", "X-Forwarded-For: 10.0.0.3\r\n");
  REQUIRE(soon([&] { return f.metrics.waiting == 2; }));
  CHECK(f.client(2).closed());  // one connection is the share of a client
}

TEST_CASE("while clients are slow to take much, nothing more is made", "[server][listener][threads]") {
  Fixture f({.max_held = 1 << 20});
  {
    Client slow = f.client();
    slow.get("/big");
    REQUIRE(soon([&] { return f.metrics.held_bytes == 64 << 20; }));
    const auto refused = f.get("/cold");
    CHECK(refused.status == 503);
    CHECK(refused.body.find("67108864 bytes") != std::string::npos);
    CHECK(f.get("/warm").status == 200);
    CHECK(f.metrics.overloaded == 1);
  }
  REQUIRE(soon([&] { return f.metrics.held_bytes == 0; }));
  CHECK(f.get("/cold").status == 200);
  CHECK(soon([&] { return f.metrics.held_bytes == 0; }));
}

TEST_CASE("the log tells what was sent of a body", "[server][listener][log]") {
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  {
    Fixture f({}, ends[1]);
    Client c = f.client();
    c.get("/a");
    CHECK(c.answer().body.size() == 22);
    c.send("HEAD /a HTTP/1.1\r\nHost: h\r\n\r\n");
    CHECK(c.answer(false).status == 200);
    Client big = f.client();
    big.get("/big");
    REQUIRE(soon([&] { return f.metrics.held_bytes > 0; }));
  }
  close(ends[1]);
  std::string text(4096, '\0');
  text.resize(static_cast<size_t>(std::max<ssize_t>(0, read(ends[0], text.data(), text.size()))));
  close(ends[0]);
  CHECK(text.find(" GET /a 200 22 ") != std::string::npos);
  CHECK(text.find(" HEAD /a 200 0 ") != std::string::npos);
  const size_t at = text.find(" GET /big 200 ");
  REQUIRE(at != std::string::npos);
  const size_t bytes = std::stoul(text.substr(at + 14));
  CHECK((bytes > 0 && bytes < 64 << 20));
}

TEST_CASE("a log that nobody reads costs lines, no answers", "[server][listener][threads]") {
  std::signal(SIGPIPE, SIG_IGN);  // as the program does
  int ends[2];
  REQUIRE(pipe(ends) == 0);
  {
    Fixture f({}, ends[1]);
    Client c = f.client();
    const std::string target = "/" + std::string(1000, 'a');
    int good = 0;
    for (int i = 0; i < 1400; ++i) {
      c.get(target);
      good += c.answer().status == 200;
    }
    CHECK(good == 1400);
    CHECK(f.log.dropped() > 0);
    close(ends[0]);  // so that the end needs no patience
  }
  close(ends[1]);
}

TEST_CASE("stopping does not wait for a client that takes nothing", "[server][listener][threads]") {
  Fixture f({.drain_timeout = 300ms});
  Client c = f.client();
  c.get("/big");
  REQUIRE(soon([&] {
    char byte;
    return recv(c.descriptor(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 1;
  }));
  CHECK_FALSE(f.stop());
}

TEST_CASE("when all connections are taken, a new one takes the place of the one that has been idle longest", "[server][listener]") {
  Fixture f({.max_connections = 3});
  Client clients[3] = {f.client(), f.client(), f.client()};
  for (Client& c : clients) {
    c.get("/");
    REQUIRE(c.answer().status == 200);
  }
  CHECK(f.get("/").status == 200);
  CHECK(soon([&] { return f.metrics.connections <= 3; }));
  int open = 0;
  for (Client& c : clients) {
    c.get("/");
    open += c.answer().status == 200;
  }
  CHECK(open == 2);
  CHECK(f.metrics.refused == 0);
}

TEST_CASE("a client gets its share of the connections and no more", "[server][listener]") {
  Fixture f({.max_connections = 4, .max_connections_per_client = 2});
  Client a = f.client(), b = f.client();
  a.get("/");
  b.get("/");
  CHECK((a.answer().status == 200 && b.answer().status == 200));
  CHECK(f.client().closed());
  CHECK(f.get("/", "", 2).status == 200);
}

TEST_CASE("busy connections beyond the limit are closed, and there is room again when others go", "[server][listener]") {
  Fixture f({.max_connections = 3});
  {
    Client a = f.client(), b = f.client(), c = f.client();
    for (Client* held : {&a, &b, &c}) held->get("/held");
    REQUIRE(soon([&] { return f.metrics.waiting == 3; }));
    Client d = f.client();
    CHECK(d.closed());
    CHECK(f.metrics.refused == 1);
    f.door.open();
  }
  REQUIRE(soon([&] { return f.metrics.connections == 0; }));
  CHECK(f.get("/").status == 200);
}

TEST_CASE("400 idle and half-sent connections: health at once, then they are dropped and their memory and descriptors too", "[server][listener]") {
  const size_t descriptors = teracell::testing::open_descriptors();
  {
    Fixture f({.max_connections_per_client = 1000, .request_timeout = 2s});
    const uint64_t before = resident_bytes();
    {
      std::vector<std::unique_ptr<Client>> clients;
      for (int i = 0; i < 400; ++i) {
        clients.push_back(std::make_unique<Client>(f.listener->url()));
        if (i % 2) clients.back()->send("GET /healthz HTTP/1.1\r\nHo");
      }
      REQUIRE(soon([&] { return f.metrics.connections == 400; }));
      const auto start = std::chrono::steady_clock::now();
      CHECK(f.get("/healthz").status == 200);
      CHECK(std::chrono::steady_clock::now() - start < 500ms);
      CHECK(resident_bytes() < before + (uint64_t{64} << 20));
      REQUIRE(soon([&] { return f.metrics.connections == 0; }));
      CHECK(f.metrics.slow_requests == 200);
      CHECK(f.metrics.idle == 200);
    }
  }
  CHECK(teracell::testing::open_descriptors() == descriptors);
}

TEST_CASE("stopping: idle ones are closed, nobody new comes in, what is under way is answered", "[server][listener][threads]") {
  Fixture f;
  Client idle = f.client(), half = f.client(), held = f.client();
  idle.get("/");
  CHECK(idle.answer().status == 200);
  half.send("GET /");
  held.get("/held");
  f.door.wait_for(1);
  f.listener->stop();
  CHECK(idle.closed());
  CHECK(half.closed());
  CHECK(soon([&] { return !f.client().open(); }));
  f.door.open();
  const auto a = held.answer();
  CHECK(a.status == 200);
  CHECK(a.has("Connection: close"));
  CHECK(held.closed());
  CHECK(f.result.get());
}

TEST_CASE("stopping does not wait for ever for what is being made", "[server][listener][threads]") {
  Fixture f({.drain_timeout = 100ms});
  Client held = f.client();
  held.get("/held");
  f.door.wait_for(1);
  CHECK_FALSE(f.stop());
}

TEST_CASE("a port in use, and a host that is not this machine's", "[server][listener]") {
  Fixture f;
  ListenerOptions o;
  o.port = static_cast<uint16_t>(std::stoi(f.listener->url().substr(17)));
  CHECK_THROWS_WITH(Listener(o, {}, f.metrics, f.log), Catch::Contains("Address already in use") && Catch::Contains("another port"));
  o.host = "192.0.2.1";
  CHECK_THROWS_WITH(Listener(o, {}, f.metrics, f.log), Catch::Contains("192.0.2.1"));
  o.host = "no such host";
  CHECK_THROWS_WITH(Listener(o, {}, f.metrics, f.log), Catch::StartsWith("can't listen at no such host: "));
}

TEST_CASE("a listener for which there are too few descriptors is an error, and its threads end", "[server][listener][threads]") {
  if (kSanitized) return;  // the sanitizers look at pointers through a pipe, for which there is no descriptor either
  Metrics metrics;
  AccessLog log(LogFormat::kNone, 2);
  ListenerOptions o;
  o.port = 0;
  o.threads = 8;
  rlimit limit{};
  REQUIRE(getrlimit(RLIMIT_NOFILE, &limit) == 0);
  const rlimit few{teracell::testing::open_descriptors() + 8, limit.rlim_max};
  REQUIRE(setrlimit(RLIMIT_NOFILE, &few) == 0);
  std::string message;
  try {
    Listener(o, {}, metrics, log);
  } catch (const IoError& e) {
    message = e.what();
  }
  REQUIRE(setrlimit(RLIMIT_NOFILE, &limit) == 0);
  CHECK_THAT(message, Catch::StartsWith("can't start io thread ") && Catch::Contains("Too many open files"));
}

TEST_CASE("a hangup is told, and stops the listener only when the callback says so", "[server][listener][threads]") {
  std::atomic<int> hangups = 0;
  Fixture f({.on_hangup = [&] { return ++hangups < 3; }});
  for (int n = 1; n <= 2; ++n) {
    REQUIRE(kill(getpid(), SIGHUP) == 0);
    REQUIRE(soon([&] { return hangups == n; }));
    CHECK(f.get("/").status == 200);
  }
  REQUIRE(kill(getpid(), SIGHUP) == 0);
  CHECK(f.result.get());
}

TEST_CASE("many clients at once, answers that change meanwhile, then a stop", "[server][listener][threads]") {
  std::mutex mutex;
  Body body = body_of(std::string(3000, 'a'));
  const auto answer = [&](const Request&) {
    std::lock_guard lock(mutex);
    return Response{.content_type = "text/plain", .body = body, .route = "echo"};
  };
  std::atomic<int> turn{0};
  Metrics metrics;
  AccessLog log(LogFormat::kNone, 2);
  ListenerOptions o;
  o.port = 0;
  o.threads = 3;
  o.allowed_hosts = {"*"};
  Listener listener(o,
                    with_operations({[&](const Request& r) { return turn++ % 3 ? std::optional(answer(r)) : std::nullopt; }, answer}, metrics,
                                    [] { return ServerState{}; }),
                    metrics, log);
  auto result = std::async(std::launch::async, [&] { return listener.run(); });
  std::atomic<bool> stop{false};
  std::atomic<uint64_t> answered{0}, wrong{0};
  {
    std::vector<std::jthread> clients;
    for (int t = 0; t < 4; ++t)
      clients.emplace_back([&, t] {
        while (!stop) {
          Client c(listener.url());
          for (int i = 0; i < 50 && !stop; ++i) {
            const bool ok = c.get(i % 10 == t ? "/metrics" : "/tile") && (i % 17 != 16 || c.get("/tile"));
            const auto a = c.answer();
            if (i % 17 == 16) c.answer();
            if (!ok || a.status != 200 || (i % 10 != t && a.body.find_first_not_of(a.body[0]) != std::string::npos)) {
              if (!stop) ++wrong;
              break;
            }
            ++answered;
          }
        }
      });
    for (char c = 'b'; c <= 'z'; ++c) {
      std::this_thread::sleep_for(20ms);
      std::lock_guard lock(mutex);
      body = body_of(std::string(3000, c));
    }
    stop = true;
    listener.stop();
  }
  CHECK(result.get());
  CHECK(answered > 100);
  CHECK(wrong == 0);
  CHECK(metrics.connections == 0);
}
