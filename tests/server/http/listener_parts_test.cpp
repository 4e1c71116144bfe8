// Answers that are made in parts as they are taken.
#include "tests/server/http/listening.hpp"
#include "tests/support/pipe.hpp"

using namespace teracell;
using namespace teracell::server;
using namespace teracell::testing;

TEST_CASE("an answer in parts is sent in chunks, and the connection goes on", "[server][listener][threads]") {
  Fixture f;
  HttpClient c = f.client();
  for (int i = 0; i < 2; ++i) {
    c.send("GET /parts HTTP/1.1\r\nHost: h\r\n\r\nGET /cold HTTP/1.1\r\nHost: h\r\n\r\n");
    const auto a = c.answer();
    CHECK(a.status == 200);
    CHECK(a.has("Transfer-Encoding: chunked"));
    CHECK(a.head.find("Content-Length") == std::string::npos);
    REQUIRE(a.whole);
    REQUIRE(a.body == TestParts::whole());
    CHECK(c.answer().body == "GET /cold http://h  false");
  }
  CHECK(f.metrics.cut == 0);
  CHECK(soon([&] { return f.metrics.held_bytes == 0; }));
  CHECK(soon([&] { return f.metrics.waiting == 0; }));
}

TEST_CASE("HEAD of an answer in parts has no body, and nothing more of it is made", "[server][listener][threads]") {
  Fixture f;
  HttpClient c = f.client();
  c.send("HEAD /parts HTTP/1.1\r\nHost: h\r\n\r\n");
  const auto head = c.answer(false);
  CHECK(head.status == 200);
  CHECK(head.head.find("Content-Length") == std::string::npos);
  c.get("/cold");
  CHECK(c.answer().body == "GET /cold http://h  false");
  CHECK(f.parts_made == 0);
}

TEST_CASE("to a client of HTTP/1.0 the end of the connection is the end of an answer in parts", "[server][listener][threads]") {
  Fixture f;
  HttpClient c = f.client();
  c.send("GET /parts HTTP/1.0\r\nConnection: keep-alive\r\n\r\n");
  const auto a = c.answer();
  CHECK(a.has("Connection: close"));
  CHECK(a.head.find("chunked") == std::string::npos);
  CHECK(a.whole);
  CHECK(a.body == TestParts::whole());
}

TEST_CASE("an answer whose next part can't be made is cut so that the client notices, and log and metrics say so", "[server][listener][threads]") {
  testing::Pipe log;
  {
    Fixture f({.work_timeout = 300ms}, log.in);
    for (const char* target : {"/parts/damaged", "/parts/no_memory", "/parts/endless"})
      for (const char* version : {"1.1", "1.0"}) {
        INFO(target << " " << version);
        HttpClient c = f.client();
        c.send(fmt::format("GET {} HTTP/{}\r\nHost: h\r\n\r\n", target, version));
        const auto a = c.answer();
        CHECK((a.status == 200 || a.status == 0));  // a reset may overtake all of it
        CHECK_FALSE(a.whole);
        CHECK(a.body.size() < TestParts::whole().size());
      }
    CHECK(soon([&] { return f.metrics.connections == 0; }));
    CHECK(f.metrics.cut == 6);
    CHECK(soon([&] { return f.metrics.held_bytes == 0; }));
    CHECK(f.get("/cold").status == 200);
  }
  const std::string text = log.rest();
  CHECK(text.find(" GET /parts/damaged 200 ") != std::string::npos);
  size_t cut = 0;
  for (size_t at = 0; (at = text.find(" parts cut\n", at)) != std::string::npos; ++at) ++cut;
  CHECK(cut == 6);
}

TEST_CASE("while clients are slow to take answers in parts, one part of each is held", "[server][listener][threads]") {
  Fixture f({.max_held = 2 << 20});
  constexpr int kClients = 8;
  std::vector<std::unique_ptr<HttpClient>> slow;
  for (int i = 0; i < kClients; ++i) {
    slow.push_back(std::make_unique<HttpClient>(f.listener->url()));
    const int few = 1 << 16;  // bytes that the system keeps for the client
    setsockopt(slow.back()->descriptor(), SOL_SOCKET, SO_RCVBUF, &few, sizeof few);
    slow.back()->get("/parts");
  }
  // A whole answer has 12 MB, more than what all may hold.
  constexpr uint64_t kLeast = 60'000, kMost = 60'000 + TestParts::kParts + TestParts::kMemory;
  REQUIRE(soon([&] { return f.metrics.waiting == 0 && f.metrics.held_bytes >= kClients * kLeast; }));
  CHECK(f.metrics.held_bytes <= kClients * kMost);
  CHECK(f.get("/cold").status == 200);
  for (const auto& c : slow) {
    const auto a = c->answer();
    REQUIRE(a.whole);
    REQUIRE(a.body == TestParts::whole());
  }
  CHECK(soon([&] { return f.metrics.held_bytes == 0; }));
}

TEST_CASE("a client that takes an answer in parts too slowly is given up", "[server][listener][threads]") {
  Fixture f({.answer_timeout = 500ms});  // for 16 kB, again and again
  HttpClient c = f.client();
  c.get("/parts");
  char byte;
  const auto stopped = [&] { return f.metrics.slow_answers == 1; };
  for (int i = 0; i < 1000 && !stopped(); ++i, std::this_thread::sleep_for(10ms)) recv(c.descriptor(), &byte, 1, MSG_DONTWAIT);
  CHECK(stopped());
  CHECK(soon([&] { return f.metrics.held_bytes == 0; }));
}

TEST_CASE("nothing more is made of an answer in parts when its client has gone", "[server][listener][threads]") {
  // Where the client's window is full, the system may tell late or never that it has gone; then it is given up as a slow one.
  Fixture f({.answer_timeout = 1s, .work_timeout = std::chrono::hours(1)});
  {
    HttpClient c = f.client();
    c.get("/parts/endless");
    std::thread reader([&] { c.answer(); });
    REQUIRE(soon([&] { return f.parts_made == 99; }));
    shutdown(c.descriptor(), SHUT_RDWR);
    reader.join();
  }
  CHECK(soon([&] { return f.metrics.connections == 0; }));
  CHECK(f.metrics.waiting == 0);
  CHECK(f.metrics.cut == 0);
}

TEST_CASE("stopping lets an answer in parts go on until the drain limit", "[server][listener][threads]") {
  Fixture f({.drain_timeout = 10s});
  HttpClient c = f.client();
  c.get("/parts");
  REQUIRE(soon([&] { return f.parts_made > 0; }));
  f.listener->stop();
  const auto a = c.answer();
  CHECK(a.whole);
  CHECK(a.body == TestParts::whole());
  CHECK(f.result.get());
  Fixture endless({.work_timeout = 2s, .drain_timeout = 100ms});
  HttpClient d = endless.client();
  d.get("/parts/endless");
  std::thread reader([&] { d.answer(); });
  REQUIRE(soon([&] { return endless.parts_made == 99; }));
  CHECK_FALSE(endless.stop());
  shutdown(d.descriptor(), SHUT_RDWR);
  reader.join();
}
