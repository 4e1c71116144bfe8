// What clients share, what they have to wait for, and what ends their waiting.
#include "store/base/system/system.hpp"
#include "tests/server/http/listening.hpp"
#include "tests/support/pipe.hpp"
#include "tests/support/stored.hpp"

using namespace teracell;
using namespace teracell::server;
using namespace teracell::testing;

TEST_CASE("health is answered while every thread of the pool is busy, and further requests get 503", "[server][listener][threads]") {
  Fixture f({.max_waiting = 3});
  HttpClient held[3] = {f.client(), f.client(), f.client()};
  for (HttpClient& c : held) c.get("/held");
  f.door.wait_for(2);  // as many as threads
  REQUIRE(soon([&] { return f.metrics.waiting == 3; }));
  CHECK(f.get("/healthz").body == R"({"status":"ok"})");
  const auto refused = f.get("/cold");
  CHECK(refused.status == 503);
  CHECK(refused.has("Retry-After: 1"));
  f.door.open();
  for (HttpClient& c : held) CHECK(c.answer().status == 200);
  CHECK(f.get("/cold").status == 200);
  CHECK(f.metrics.waiting == 0);
}

TEST_CASE("no answer is made for a client that has gone", "[server][listener][threads]") {
  Fixture f;
  HttpClient first = f.client(), second = f.client();
  first.get("/held");
  second.get("/held");
  f.door.wait_for(2);
  {
    HttpClient gone = f.client();
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
  CHECK(refused.head.find("Retry-After") == std::string::npos);  // it would take as long again
  Fixture patient({.work_timeout = std::chrono::hours(1)});
  {
    HttpClient c = patient.client();
    c.get("/cold/endless");
    REQUIRE(soon([&] { return patient.metrics.waiting == 1; }));
  }
  CHECK(soon([&] { return patient.metrics.waiting == 0; }));
  {
    HttpClient c = patient.client();
    c.get("/cold/endless");
    REQUIRE(soon([&] { return patient.metrics.waiting == 1; }));
    c.send("G");  // not read yet
  }
  CHECK(soon([&] { return patient.metrics.waiting == 0; }));
}

TEST_CASE("who is idle or slow is dropped in time, and counted", "[server][listener]") {
  Fixture f({.request_timeout = 400ms, .idle_timeout = 800ms});
  HttpClient silent = f.client(), half = f.client(), trickling = f.client(), idle = f.client();
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
  HttpClient c = f.client();
  c.get("/big");
  REQUIRE(soon([&] { return f.metrics.slow_answers == 1; }));
  REQUIRE(soon([&] { return f.metrics.connections == 0; }));
  CHECK(c.answer().body.size() < 64 << 20);
}

TEST_CASE("an answer that is taken slowly is given up when it falls behind the least rate, however large it is", "[server][listener]") {
  Fixture f({.answer_timeout = 500ms});
  HttpClient c = f.client();
  c.get("/big");
  char byte;
  const auto stopped = [&] { return f.metrics.slow_answers == 1; };
  for (int i = 0; i < 1000 && !stopped(); ++i, std::this_thread::sleep_for(10ms)) recv(c.descriptor(), &byte, 1, MSG_DONTWAIT);
  CHECK(stopped());
}

TEST_CASE("a client that holds its share of the answers leaves room for others", "[server][listener][threads]") {
  Fixture f({.max_held = 100 << 20});
  HttpClient slow = f.client();
  slow.get("/big");
  REQUIRE(soon([&] { return f.metrics.held_bytes == 64 << 20; }));
  CHECK(f.get("/cold").status == 503);
  CHECK(f.get("/big").status == 503);  // also what is at hand
  CHECK(f.get("/warm").status == 200);
  CHECK(f.get("/cold", "", 2).status == 200);
}

TEST_CASE("a client that waits for its share of the work leaves room for others", "[server][listener][threads]") {
  Fixture f({.max_waiting = 4, .max_waiting_per_client = 2});
  HttpClient a = f.client(), b = f.client();
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
  HttpClient a = f.client();
  a.get("/held?dear", "X-Forwarded-For: 6.6.6.6, 10.0.0.1\r\n");
  REQUIRE(soon([&] { return f.metrics.waiting == 1; }));
  CHECK(f.get("/cold", "X-Forwarded-For: 10.0.0.1\r\n").status == 503);
  CHECK(f.get("/cold", "X-Forwarded-For: 10.0.0.2\r\n").status == 200);
  HttpClient b = f.client(2);
  b.get("/held?dear", "X-Forwarded-For: 10.0.0.3\r\n");
  REQUIRE(soon([&] { return f.metrics.waiting == 2; }));
  CHECK(f.get("/", "", 2).status == 503);  // one connection is the share of a client
}

TEST_CASE("while clients are slow to take much, nothing more is made", "[server][listener][threads]") {
  Fixture f({.max_held = 1 << 20});
  {
    HttpClient slow = f.client();
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
  testing::Pipe log;
  {
    Fixture f({}, log.in);
    HttpClient c = f.client();
    c.get("/a");
    CHECK(c.answer().body.size() == 22);
    c.send("HEAD /a HTTP/1.1\r\nHost: h\r\n\r\n");
    CHECK(c.answer(false).status == 200);
    HttpClient big = f.client();
    big.get("/big");
    REQUIRE(soon([&] { return f.metrics.held_bytes > 0; }));
  }
  const std::string text = log.rest();
  CHECK(text.find(" GET /a 200 22 ") != std::string::npos);
  CHECK(text.find(" HEAD /a 200 0 ") != std::string::npos);
  const size_t at = text.find(" GET /big 200 ");
  REQUIRE(at != std::string::npos);
  const size_t bytes = std::stoul(text.substr(at + 14));
  CHECK((bytes > 0 && bytes < 64 << 20));
}

TEST_CASE("a log that nobody reads costs lines, no answers", "[server][listener][threads]") {
  std::signal(SIGPIPE, SIG_IGN);  // as the program does
  testing::Pipe log;
  {
    Fixture f({}, log.in);
    HttpClient c = f.client();
    const std::string target = "/" + std::string(1000, 'a');
    int good = 0;
    for (int i = 0; i < 1400; ++i) {
      c.get(target);
      good += c.answer().status == 200;
    }
    CHECK(good == 1400);
    CHECK(f.log.dropped() > 0);
    log.close_out();  // so that the end needs no patience
  }
}

TEST_CASE("stopping does not wait for a client that takes nothing", "[server][listener][threads]") {
  Fixture f({.drain_timeout = 300ms});
  HttpClient c = f.client();
  c.get("/big");
  REQUIRE(soon([&] {
    char byte;
    return recv(c.descriptor(), &byte, 1, MSG_PEEK | MSG_DONTWAIT) == 1;
  }));
  CHECK_FALSE(f.stop());
}

TEST_CASE("when all connections are taken, a new one takes the place of the one that has been idle longest", "[server][listener]") {
  Fixture f({.max_connections = 3});
  HttpClient clients[3] = {f.client(), f.client(), f.client()};
  for (HttpClient& c : clients) {
    c.get("/");
    REQUIRE(c.answer().status == 200);
  }
  CHECK(f.get("/").status == 200);
  CHECK(soon([&] { return f.metrics.connections <= 3; }));
  int open = 0;
  for (HttpClient& c : clients) {
    c.get("/");
    open += c.answer().status == 200;
  }
  CHECK(open == 2);
  CHECK(f.metrics.refused == 0);
}

TEST_CASE("a client gets its share of the connections and no more", "[server][listener]") {
  Fixture f({.max_connections = 4, .max_connections_per_client = 2});
  HttpClient a = f.client(), b = f.client();
  a.get("/");
  CHECK(a.answer().status == 200);
  std::this_thread::sleep_for(100ms);
  b.get("/");
  CHECK(b.answer().status == 200);
  HttpClient c = f.client();  // takes the place of the one that has been idle longest, which is not that of another client
  c.get("/");
  CHECK(c.answer().status == 200);
  CHECK(a.closed());
  b.get("/");
  CHECK(b.answer().status == 200);
  CHECK(f.get("/", "", 2).status == 200);
  b.get("/held");
  c.get("/held");
  REQUIRE(soon([&] { return f.metrics.waiting == 2; }));
  const auto refused = f.get("/");
  CHECK(refused.status == 503);
  CHECK(refused.has("Retry-After: 1"));
  CHECK(refused.has("Connection: close"));
  CHECK(f.metrics.refused == 1);
  f.door.open();
}

TEST_CASE("many that come at once take the places of idle ones, each of another one, and no more are served than a client may have",
          "[server][listener][threads]") {
  Fixture f({.max_connections = 8, .max_connections_per_client = 4});
  std::vector<std::unique_ptr<HttpClient>> clients;
  for (int i = 0; i < 40; ++i) clients.push_back(std::make_unique<HttpClient>(f.listener->url()));
  REQUIRE(soon([&] { return f.metrics.connections == 4; }));
  CHECK(soon([&] { return f.get("/").status == 200; }));
  CHECK(soon([&] { return f.metrics.connections <= 4; }));
}

TEST_CASE("while an idle connection can't give way at once, no more than a few are served beyond the limit", "[server][listener][threads]") {
  for (const size_t share : {40, 1000}) {  // the client's own give way, or any
    Fixture f({.max_connections = 40, .max_connections_per_client = share});
    std::vector<std::unique_ptr<HttpClient>> clients;
    for (int i = 0; i < 40; ++i) {
      clients.push_back(std::make_unique<HttpClient>(f.listener->url()));
      clients.back()->get("/");
      REQUIRE(clients.back()->answer().status == 200);
    }
    clients[1]->get("/stuck");
    f.stuck.wait_for(1);
    const uint64_t before = f.metrics.accepted;
    for (int i = 0; i < 60; ++i) clients.push_back(std::make_unique<HttpClient>(f.listener->url()));
    REQUIRE(soon([&] { return f.metrics.accepted == before + 60; }));
    CHECK(f.metrics.connections <= 40 + ListenerOptions::kMostBeyond);
    f.stuck.open();
    CHECK(soon([&] { return f.metrics.connections <= 40; }));
  }
}

TEST_CASE("connections beyond the limit are told so while all others are busy, and there is room again when others go", "[server][listener]") {
  Fixture f({.max_connections = 3});
  {
    HttpClient a = f.client(), b = f.client(), c = f.client();
    for (HttpClient* held : {&a, &b, &c}) held->get("/held");
    REQUIRE(soon([&] { return f.metrics.waiting == 3; }));
    CHECK(f.get("/").status == 503);
    CHECK(f.metrics.refused == 1);
    HttpClient silent = f.client();
    CHECK(silent.closed());
    std::vector<std::unique_ptr<HttpClient>> more;
    for (uint64_t i = 0; i < ListenerOptions::kMostRefused; ++i) more.push_back(std::make_unique<HttpClient>(f.listener->url()));
    REQUIRE(soon([&] { return f.metrics.refused == 2 + ListenerOptions::kMostRefused; }));
    CHECK(f.client().closed());
    f.door.open();
  }
  REQUIRE(soon([&] { return f.metrics.connections == 0; }));
  CHECK(f.get("/").status == 200);
}

TEST_CASE("400 idle and half-sent connections: health at once, then they are dropped and their memory and descriptors too", "[server][listener]") {
  const size_t descriptors = teracell::testing::open_descriptors();
  {
    Fixture f({.max_connections_per_client = 1000, .request_timeout = 2s});
    const uint64_t before = system::resident_bytes();
    {
      std::vector<std::unique_ptr<HttpClient>> clients;
      for (int i = 0; i < 400; ++i) {
        clients.push_back(std::make_unique<HttpClient>(f.listener->url()));
        if (i % 2) clients.back()->send("GET /healthz HTTP/1.1\r\nHo");
      }
      REQUIRE(soon([&] { return f.metrics.connections == 400; }));
      const auto start = std::chrono::steady_clock::now();
      CHECK(f.get("/healthz").status == 200);
      CHECK(std::chrono::steady_clock::now() - start < 500ms);
      CHECK(system::resident_bytes() < before + (uint64_t{64} << 20));
      REQUIRE(soon([&] { return f.metrics.connections == 0; }));
      CHECK(f.metrics.slow_requests == 200);
      CHECK(f.metrics.idle == 200);
    }
  }
  CHECK(teracell::testing::open_descriptors() == descriptors);
}

TEST_CASE("stopping: idle ones are closed, nobody new comes in, what is under way is answered", "[server][listener][threads]") {
  Fixture f;
  HttpClient idle = f.client(), half = f.client(), held = f.client();
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
  HttpClient held = f.client();
  held.get("/held");
  f.door.wait_for(1);
  CHECK_FALSE(f.stop());
}
