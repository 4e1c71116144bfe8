// Whole sessions: a real connection gets the input through a pair of sockets. What it sends back must be one well-formed response for
// each request that it counts, with known fields alone and bodies of the length that is told. No status is 500: the grids are sound.
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <string_view>

#include <unistd.h>

#include "server/api/routes.hpp"
#include "server/http/connection.hpp"
#include "tests/support/stored.hpp"

namespace teracell::server {
namespace {

using namespace testing;

std::filesystem::path folder() { return std::filesystem::temp_directory_path() / ("session_fuzz." + std::to_string(getpid())); }

// A grid with some of everything, and one with a column that comes in parts.
ServiceOptions two_grids() {
  std::filesystem::create_directories(folder());
  std::atexit([] { std::filesystem::remove_all(folder()); });
  std::mt19937_64 random(1);
  const Grid grid{{Axis::uniform(0, 1, 0, 19, 0.5), Axis::graded({0, 1, 3, 4, 8, 9, 12}, 0.5), Axis::uniform(-1, 0.5, 2, 9, 0)}};
  store_cells(folder() / "g.tcell", with_tiny_chunks(metadata_of(grid, 1, 4)), random_cells(random, grid.cells(), 4));
  Metadata meta = metadata_of(unit_grid({1, 1, 900}), 2, 2);
  meta.materials[1].name = std::string(256, '"');
  std::vector<Label> cells(900);
  for (size_t i = 0; i < cells.size(); ++i) cells[i] = i % 2;
  store_cells(folder() / "l.tcell", meta, cells);
  return {.named = {folder()}, .cache_bytes = 1 << 20, .max_pixels = 1000};
}

ListenerOptions listener_options() { return {.base_path = "/b", .allowed_origins = {"https://viewer.example"}}; }

struct Server {
  Service service{two_grids()};
  Metrics metrics;
  AccessLog log{LogFormat::kNone, 2};
  Shared shared{listener_options(), with_operations(handler_of(service), metrics, [] { return ServerState{}; }), metrics, log};
  uint64_t answered() const {
    uint64_t n = 0;
    for (const Metrics::Route& r : metrics.routes())
      for (const auto& s : r.statuses) n += s;
    return n;
  }
};

Server& server() {
  static Server* const made = new Server;
  return *made;
}

void require(bool good) {
  if (!good) std::abort();
}

// Removes what ends with `end` from the front, without the end.
std::string_view take_until(std::string_view& text, std::string_view end) {
  const size_t at = text.find(end);
  require(at != text.npos);
  const std::string_view out = text.substr(0, at);
  text.remove_prefix(at + end.size());
  return out;
}

std::string_view take_bytes(std::string_view& text, size_t n) {
  require(n <= text.size());
  const std::string_view out = text.substr(0, n);
  text.remove_prefix(n);
  return out;
}

// Removes a response from the front. Returns its status.
int take_response(std::string_view& text) {
  constexpr std::array<std::string_view, 20> kKnown = {"Server",
                                                       "Date",
                                                       "X-Content-Type-Options",
                                                       "Access-Control-Expose-Headers",
                                                       "Access-Control-Allow-Origin",
                                                       "Vary",
                                                       "Content-Type",
                                                       "Content-Length",
                                                       "Transfer-Encoding",
                                                       "ETag",
                                                       "Cache-Control",
                                                       "Content-Encoding",
                                                       "Location",
                                                       "Access-Control-Allow-Methods",
                                                       "Access-Control-Allow-Headers",
                                                       "Access-Control-Max-Age",
                                                       "Allow",
                                                       "Retry-After",
                                                       "Connection",
                                                       "WWW-Authenticate"};
  std::string_view head = take_until(text, "\r\n\r\n");
  for (const char c : head) require(c == '\r' || c == '\n' || (c >= 0x20 && c != 0x7f) || static_cast<unsigned char>(c) >= 0x80);
  std::string all(head);
  all += "\r\n";
  std::string_view lines = all;
  const std::string_view first = take_until(lines, "\r\n");
  require(first.starts_with("HTTP/1.1 ") && first.size() > 13 && first[12] == ' ');
  const int status = std::stoi(std::string(first.substr(9, 3)));
  std::string_view length, coding, connection;
  while (!lines.empty()) {
    std::string_view line = take_until(lines, "\r\n");
    require(line.find_first_of("\r\n") == line.npos);
    const std::string_view name = take_until(line, ": ");
    require(std::ranges::find(kKnown, name) != kKnown.end());
    if (name == "Content-Length") require(length.empty()), length = line;
    if (name == "Connection") require(connection.empty()), connection = line;
    if (name == "Transfer-Encoding") require(coding.empty() && line == "chunked"), coding = line;
  }
  const bool empty = status == 204 || status == 304;
  const bool until_end = !empty && length.empty() && coding.empty();  // to a client of HTTP/1.0
  require(empty ? length.empty() && coding.empty() : length.empty() || coding.empty());
  require(!until_end || connection == "close");
  // Bodies don't begin like a response: what does so follows a response to HEAD.
  if (empty || text.empty() || text.starts_with("HTTP/1.1 ")) return status;
  if (until_end) {
    text = {};
  } else if (!coding.empty()) {
    for (;;) {
      const size_t size = std::stoul(std::string(take_until(text, "\r\n")), nullptr, 16);
      take_bytes(text, size);
      require(take_bytes(text, 2) == "\r\n");
      if (size == 0) break;
    }
  } else {
    take_bytes(text, std::stoul(std::string(length)));
  }
  return status;
}

// What a connection sends to a client that sends `input`.
std::string answers_to(std::string_view input) {
  int ends[2];
  require(socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK, 0, ends) == 0);
  std::string out;
  const auto read_some = [&] {
    char bytes[65536];
    ssize_t n;
    while ((n = recv(ends[0], bytes, sizeof bytes, 0)) > 0) out.append(bytes, static_cast<size_t>(n));
  };
  {
    Loop loop(server().shared);
    Socket socket(loop.io, tcp::v4(), ends[1]);
    serve_connection(loop, std::move(socket), {server().shared.clients.at("client"), false, {}, {}});
    const auto settle = [&] {
      for (;;) {
        loop.io.restart();
        const bool moved = loop.io.poll() > 0;
        read_some();
        int left = 0;
        if (loop.connections.empty() || ioctl(ends[1], FIONREAD, &left) != 0) return;
        if (server().metrics.waiting > 0) loop.io.run_one_for(std::chrono::milliseconds(1));
        else if (!moved && left == 0) return;
      }
    };
    settle();
    while (!input.empty() && !loop.connections.empty()) {
      const ssize_t n = ::send(ends[0], input.data(), std::min<size_t>(input.size(), 4096), MSG_NOSIGNAL);
      if (n <= 0) break;
      input.remove_prefix(static_cast<size_t>(n));
      settle();
    }
    shutdown(ends[0], SHUT_WR);  // only now: a client that has ended gets no more answers
    settle();
    require(loop.connections.empty());
  }
  read_some();
  close(ends[0]);
  return out;
}

}  // namespace
}  // namespace teracell::server

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace teracell::server;
  if (size > 32768) return 0;
  const uint64_t before = server().answered();
  const std::string out = answers_to({reinterpret_cast<const char*>(data), size});
  std::string_view text = out;
  uint64_t responses = 0;
  for (; !text.empty(); ++responses) {
    const int status = take_response(text);
    constexpr std::array kExpected = {200, 204, 302, 303, 304, 400, 404, 405, 413, 414, 421, 431, 505};
    require(std::ranges::find(kExpected, status) != kExpected.end());
  }
  require(responses == server().answered() - before);
  require(server().service.counters().damaged == 0 && server().metrics.waiting == 0 && server().metrics.held_bytes == 0);
  return 0;
}
