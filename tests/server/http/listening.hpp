// A listener over real sockets, with a simple handler, and a plain client.
#pragma once
#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "server/http/listener.hpp"
#include "store/base/wanted.hpp"
#include "tests/support/test.hpp"

namespace teracell::server {

using namespace std::chrono_literals;

// A plain client. It waits for anything at most ten seconds.
class HttpClient {
 public:
  // `from` is the last number of the address that it comes from, 127.0.0.from.
  explicit HttpClient(const std::string& url, uint32_t from = 1) : fd_(socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in a{};
    a.sin_family = AF_INET;
    a.sin_addr.s_addr = htonl(INADDR_LOOPBACK - 1 + from);
    bind(fd_, reinterpret_cast<sockaddr*>(&a), sizeof a);
    a.sin_port = htons(static_cast<uint16_t>(std::stoi(url.substr(url.find(':', 7) + 1))));
    a.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    open_ = connect(fd_, reinterpret_cast<sockaddr*>(&a), sizeof a) == 0;
  }
  ~HttpClient() { close(fd_); }
  HttpClient(const HttpClient&) = delete;

  bool open() const { return open_; }
  bool send(const std::string& text) { return ::send(fd_, text.data(), text.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(text.size()); }
  bool get(const std::string& target, const std::string& fields = "") { return send("GET " + target + " HTTP/1.1\r\nHost: h\r\n" + fields + "\r\n"); }

  struct Answer {
    int status = 0;  // 0: there was no answer
    std::string head, body;
    bool whole = false;  // the body has ended as HTTP says
    bool has(const std::string& line) const { return head.find("\r\n" + line + "\r\n") != std::string::npos; }
  };
  Answer answer(bool with_body = true) {
    Answer a;
    a.head = until("\r\n\r\n");
    if (a.head.empty()) return a;
    a.head.resize(a.head.size() - 2);
    a.status = std::stoi(a.head.substr(9));
    const size_t length = a.head.find("Content-Length: ");
    if (!with_body || a.status == 204 || a.status == 304) {
      a.whole = true;
    } else if (a.has("Transfer-Encoding: chunked")) {
      for (size_t size = 1; size > 0; a.whole = size == 0) {
        const std::string line = until("\r\n");
        if (line.empty()) break;
        size = std::stoul(line, nullptr, 16);
        const std::string chunk = bytes(size + 2);
        if (chunk.size() < size + 2 || !chunk.ends_with("\r\n")) break;
        a.body.append(chunk, 0, size);
      }
    } else if (length != std::string::npos) {
      const size_t size = std::stoul(a.head.substr(length + 16));
      a.body = bytes(size);
      a.whole = a.body.size() == size;
    } else {
      a.body = bytes(~size_t{0});
      a.whole = ended_ && !reset_;
    }
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
    if (n <= 0) return ended_ = true, reset_ = n < 0, false;
    in_.append(bytes, static_cast<size_t>(n));
    return true;
  }
  // What comes before and with `end`; nothing when it does not come.
  std::string until(const std::string& end) {
    size_t at;
    while ((at = in_.find(end)) == std::string::npos)
      if (!more()) return "";
    return taken(at + end.size());
  }
  std::string bytes(size_t n) {
    while (in_.size() < n)
      if (!more()) break;
    return taken(n);
  }
  std::string taken(size_t n) {
    const std::string out = in_.substr(0, n);
    in_.erase(0, n);
    return out;
  }
  int fd_;
  bool open_ = false, ended_ = false, reset_ = false;
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

// An answer in kParts parts of different sizes.
class TestParts : public Parts {
 public:
  static constexpr int kParts = 200;
  static constexpr size_t kMemory = 5000;
  static std::string part(int i) { return std::string(60'000 + static_cast<size_t>(i), static_cast<char>('a' + i % 26)); }
  static std::string whole() {
    std::string all;
    for (int i = 0; i < kParts; ++i) all += part(i);
    return all;
  }
  explicit TestParts(std::function<void(int part)> before) : before_(std::move(before)) {}
  bool append(std::string& out) override {
    before_(next_);
    out += part(next_);
    return ++next_ < kParts;
  }
  size_t memory() const override { return kMemory; }

 private:
  const std::function<void(int)> before_;
  int next_ = 1;  // the first one is made with the response
};

// A listener that runs while the fixture lives. Answers contain what was asked for.
struct Fixture {
  Door door, stuck;
  Metrics metrics;
  AccessLog log;
  std::atomic<int> parts_made = 0;  // behind the first ones
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
    const auto in_parts = [this](const std::string& target) {
      Response a{.content_type = "text/plain", .body = body_of(TestParts::part(0)), .route = "parts"};
      a.rest = std::make_shared<TestParts>([this, target](int part) {
        while (part == 100 && target == "/parts/endless") {
          Wanted::stop_if_not();
          std::this_thread::sleep_for(1ms);
        }
        if (part == 100 && target == "/parts/damaged") throw std::runtime_error("damaged");
        if (part == 100 && target == "/parts/no_memory") throw std::bad_alloc();
        ++parts_made;
      });
      return a;
    };
    Handler h{[=, this](const Request& r) {
                if (r.target == "/stuck") stuck.wait();  // and with it an io thread
                if (r.target.starts_with("/held") || r.target.starts_with("/cold") || r.target.starts_with("/parts"))
                  return std::optional<Response>();
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
                if (r.target.starts_with("/parts")) return in_parts(r.target);
                return answer(r);
              },
              {},
              [](const Request& r) { return r.target.ends_with("dear") ? Cost::kDear : Cost::kCheap; }};
    Handler all = with_operations(std::move(h), metrics, [] { return ServerState{}; });
    all.is_open = [](std::string_view path) { return path == "/open"; };
    listener = std::make_unique<Listener>(o, all, metrics, log);
    result = std::async(std::launch::async, [this] { return listener->run(); });
  }
  ~Fixture() {
    door.open();
    stuck.open();
    listener->stop();
  }
  bool stop() {
    listener->stop();
    return result.get();
  }
  HttpClient client(uint32_t from = 1) const { return HttpClient(listener->url(), from); }
  HttpClient::Answer get(const std::string& target, const std::string& fields = "", uint32_t from = 1) const {
    HttpClient c = client(from);
    c.get(target, fields);
    return c.answer();
  }
};

inline int status_of(const Fixture& f, const std::string& text) {
  HttpClient c = f.client();
  c.send(text);
  return c.answer().status;
}

// Waits until a condition holds, at most ten seconds.
inline bool soon(const std::function<bool()>& holds) {
  for (int i = 0; i < 1000; ++i, std::this_thread::sleep_for(10ms))
    if (holds()) return true;
  return false;
}

}  // namespace teracell::server
