#include "server/http/access_log.hpp"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <ctime>
#include <iterator>

#include <fmt/format.h>

#include "store/text/json_text.hpp"

namespace teracell::server {
namespace {

using namespace std::chrono_literals;

constexpr size_t kLongest = 1024;           // bytes of a target in the log
constexpr size_t kMuch = size_t{64} << 10;  // bytes that are written at once; fewer are written after kWhile
constexpr auto kWhile = 250ms;
constexpr auto kGrace = 500ms;

void append_harmless(std::string& out, std::string_view text) {
  if (text.empty()) out += '-';
  for (const char c : text.substr(0, kLongest))
    if (c > 0x20 && c < 0x7f && c != '"' && c != '\\') out += c;
    else fmt::format_to(std::back_inserter(out), "%{:02X}", static_cast<unsigned char>(c));
  if (text.size() > kLongest) out += "...";
}

void append_note(std::string& out, LogFormat format, std::string_view time, std::string_view message) {
  if (format == LogFormat::kJson) fmt::format_to(std::back_inserter(out), R"({{"time":"{}","message":{}}})", time, ascii_json(message));
  else fmt::format_to(std::back_inserter(out), "teracell: {}", message);
  out += '\n';
}

}  // namespace

void append_log_line(std::string& out, LogFormat format, std::string_view time, const LogEntry& e) {
  const auto end = [&out] { return std::back_inserter(out); };
  if (format == LogFormat::kJson) {
    fmt::format_to(end(), R"({{"time":"{}","client":"{}","method":")", time, e.client);
    append_harmless(out, e.method);
    out += R"(","target":")";
    append_harmless(out, e.target);
    fmt::format_to(end(), R"(","status":{},"bytes":{},"ms":{:.3f},"route":"{}"{}}})", e.status, e.bytes, e.milliseconds, e.route,
                   e.cut ? R"(,"cut":true)" : "");
  } else {
    fmt::format_to(end(), "{} {} ", time, e.client);
    append_harmless(out, e.method);
    out += ' ';
    append_harmless(out, e.target);
    fmt::format_to(end(), " {} {} {:.3f} {}{}", e.status, e.bytes, e.milliseconds, e.route, e.cut ? " cut" : "");
  }
  out += '\n';
}

AccessLog::AccessLog(LogFormat format, int descriptor) : format_(format), descriptor_(descriptor), thread_([this] { work(); }) {}

void AccessLog::write(const LogEntry& entry) noexcept {
  if (format_ != LogFormat::kNone) add([&] { append_log_line(lines_, format_, time(), entry); });
}

void AccessLog::note(std::string_view message) noexcept {
  add([&] { append_note(lines_, format_, time(), message); });
}

void AccessLog::finish() {
  {
    std::lock_guard lock(mutex_);
    if (!finished_) give_up_ = std::chrono::steady_clock::now() + kGrace;
    finished_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
}

template <class Append>
void AccessLog::add(Append append) noexcept {
  bool wake = false;
  {
    std::lock_guard lock(mutex_);
    const size_t before = lines_.size();
    try {
      if (finished_ || before >= kMost) ++dropped_;
      else append();
    } catch (...) {  // no memory for the line
      lines_.resize(before);
      ++dropped_;
    }
    wake = lines_.size() > before && (before == 0 || (before < kMuch && lines_.size() >= kMuch));
  }
  if (wake) changed_.notify_all();
}

std::string_view AccessLog::time() {
  const int64_t now = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  if (now / 1000 != second_) {
    second_ = now / 1000;
    const std::time_t t = second_;
    std::tm m{};
    gmtime_r(&t, &m);
    fmt::format_to_n(time_.data(), time_.size(), "{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.", m.tm_year + 1900, m.tm_mon + 1, m.tm_mday, m.tm_hour,
                     m.tm_min, m.tm_sec);
  }
  constexpr size_t seconds = std::string_view("1970-01-01T00:00:00.").size(), all = seconds + 4;
  fmt::format_to_n(time_.data() + seconds, 4, "{:03}Z", now % 1000);
  return {time_.data(), all};
}

void AccessLog::work() {
  std::string lines;
  uint64_t told = 0;
  for (;;) {
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return finished_ || !lines_.empty(); });
      changed_.wait_for(lock, kWhile, [&] { return finished_ || lines_.size() >= kMuch; });
      if (lines_.empty()) return;
      lines.swap(lines_);
      if (const uint64_t dropped = dropped_; dropped > told) try {
          append_note(lines, format_, time(), fmt::format("{} lines of this log were dropped, because nobody read them in time", dropped - told));
          told = dropped;
        } catch (const std::bad_alloc&) {  // /metrics has the number
        }
    }
    write_through(lines);
    lines.clear();
  }
}

// Lines that can't be written, because the reader has gone or the disk is full, are lost. Serving goes on.
void AccessLog::write_through(std::string_view lines) {
  while (!lines.empty()) {
    // Whole lines, up to the size that a pipe takes without blocking once it takes anything.
    std::string_view piece = lines.substr(0, PIPE_BUF);
    if (piece.size() < lines.size()) piece = piece.substr(0, piece.rfind('\n') + 1);
    if (piece.empty()) piece = lines.substr(0, PIPE_BUF);
    const ssize_t n = takes_some() ? ::write(descriptor_, piece.data(), piece.size()) : -1;
    if (n > 0) {
      lines.remove_prefix(static_cast<size_t>(n));
    } else if (errno != EINTR && errno != EAGAIN) {
      dropped_ += static_cast<uint64_t>(std::ranges::count(lines, '\n'));
      return;
    }
  }
}

// Waits until something can be written or writing is known to fail. Returns false when the time for that has run out.
bool AccessLog::takes_some() {
  for (pollfd p{descriptor_, POLLOUT, 0}; poll(&p, 1, static_cast<int>(kWhile / 2ms)) <= 0;)
    if (finished_ && std::chrono::steady_clock::now() >= give_up_) {
      errno = ETIMEDOUT;
      return false;
    }
  return true;
}

}  // namespace teracell::server
