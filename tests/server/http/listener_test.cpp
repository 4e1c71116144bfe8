// Requests and answers over real sockets.
#include <sys/resource.h>

#include "tests/server/http/listening.hpp"
#include "tests/support/stored.hpp"

using namespace teracell;
using namespace teracell::server;
using namespace teracell::testing;

TEST_CASE("a connection serves one request after the other, also when they arrive together or in pieces", "[server][listener]") {
  Fixture f;
  HttpClient c = f.client();
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
  HttpClient c = f.client();
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
    HttpClient c = f.client();
    c.send(fmt::format("{} /a HTTP/1.1\r\nHost: h\r\nExpect: 100-continue\r\nContent-Length: 8\r\n\r\n", method));
    const auto a = c.answer();
    CHECK(a.status == status);
    CHECK(a.has("Connection: close"));
    CHECK(c.closed());
  }
}

TEST_CASE("a target with scheme and host means its own path and host", "[server][listener]") {
  Fixture f;
  HttpClient c = f.client();
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
  HttpClient c = f.client();
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
  HttpClient c = f.client();
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
  HttpClient c = f.client();
  c.send("GET / HTTP/1.1\r\nHost: h\r\n");
  for (int i = 0; i < 400 && c.send(fmt::format("X{}: {}\r\n", i, std::string(100, 'x'))); ++i) std::this_thread::sleep_for(1ms);
  CHECK(c.answer().status == 431);
}

TEST_CASE("an empty line after a request belongs to none", "[server][listener]") {
  Fixture f;
  HttpClient c = f.client();
  c.send("\r\nGET /1 HTTP/1.1\r\nHost: h\r\n\r\n\r\nGET /2 HTTP/1.1\r\nHost: h\r\n\r\n\r\n");
  CHECK(c.answer().body == "GET /1 http://h  false");
  CHECK(c.answer().body == "GET /2 http://h  false");
  c.get("/3");
  CHECK(c.answer().body == "GET /3 http://h  false");
}

TEST_CASE("a malformed request is refused with JSON, and its connection is closed", "[server][listener]") {
  Fixture f;
  HttpClient c = f.client();
  c.send("GET / HTTP/1.1\r\nHost: h\r\nbad field\r\n\r\nGET /next HTTP/1.1\r\nHost: h\r\n\r\n");
  const auto a = c.answer();
  CHECK(a.body.starts_with(R"({"error":{"code":"bad_request","message":"malformed request)"));
  CHECK(a.has("Connection: close"));
  CHECK(c.closed());
}

TEST_CASE("the client decides whether the connection is kept", "[server][listener]") {
  Fixture f;
  HttpClient closing = f.client();
  closing.get("/", "Connection: close\r\n");
  CHECK(closing.answer().has("Connection: close"));
  CHECK(closing.closed());
  HttpClient old = f.client();
  old.send("GET / HTTP/1.0\r\n\r\n");
  CHECK(old.answer().has("Connection: close"));
  CHECK(old.closed());
  HttpClient kept = f.client();
  kept.send("GET / HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
  CHECK(kept.answer().has("Connection: keep-alive"));
  kept.get("/");
  CHECK(kept.answer().status == 200);
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

TEST_CASE("a new token takes the place of the old one, also on connections that are open", "[server][listener][threads]") {
  Fixture f({.token = "secret"});
  HttpClient c = f.client();
  const auto status = [&](const std::string& token) {
    c.get("/a", "Authorization: Bearer " + token + "\r\n");
    return c.answer().status;
  };
  CHECK(status("secret") == 200);
  f.listener->use_token("fresh");
  CHECK(soon([&] { return status("fresh") == 200; }));
  CHECK(status("secret") == 401);
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

TEST_CASE("a port in use, and a host that is not this machine's", "[server][listener]") {
  Fixture f;
  ListenerOptions o{.port = static_cast<uint16_t>(std::stoi(f.listener->url().substr(17)))};
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
  rlimit limit{};
  REQUIRE(getrlimit(RLIMIT_NOFILE, &limit) == 0);
  const rlimit few{teracell::testing::open_descriptors() + 8, limit.rlim_max};
  REQUIRE(setrlimit(RLIMIT_NOFILE, &few) == 0);
  std::string message;
  try {
    Listener({.port = 0, .threads = 8}, {}, metrics, log);
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
  Listener listener({.port = 0, .threads = 3, .allowed_hosts = {"*"}},
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
          HttpClient c(listener.url());
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
