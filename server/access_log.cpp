#include "server/access_log.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <ctime>
#include <iterator>

#include <fmt/format.h>

namespace teracell {
namespace {

constexpr size_t kLongest = 1024;  // of a target in the log

void append_harmless(std::string& out, std::string_view text) {
  if (text.empty()) out += '-';
  for (const char c : text.substr(0, kLongest))
    if (c > 0x20 && c < 0x7f && c != '"' && c != '\\') out += c;
    else fmt::format_to(std::back_inserter(out), "%{:02X}", static_cast<unsigned char>(c));
  if (text.size() > kLongest) out += "...";
}

}  // namespace

void append_log_line(std::string& out, LogFormat format, std::string_view time, const LogEntry& e) {
  const auto end = [&out] { return std::back_inserter(out); };
  if (format == LogFormat::kJson) {
    fmt::format_to(end(), R"({{"time":"{}","client":"{}","method":")", time, e.client);
    append_harmless(out, e.method);
    out += R"(","target":")";
    append_harmless(out, e.target);
    fmt::format_to(end(), R"(","status":{},"bytes":{},"ms":{:.3f},"route":"{}"}})", e.status, e.bytes, e.milliseconds, e.route);
  } else {
    fmt::format_to(end(), "{} {} ", time, e.client);
    append_harmless(out, e.method);
    out += ' ';
    append_harmless(out, e.target);
    fmt::format_to(end(), " {} {} {:.3f} {}", e.status, e.bytes, e.milliseconds, e.route);
  }
  out += '\n';
}

void AccessLog::write(const LogEntry& entry) {
  if (format_ == LogFormat::kNone) return;
  const int64_t now = std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::system_clock::now().time_since_epoch()).count();
  bool much;
  {
    std::lock_guard lock(mutex_);
    if (now / 1000 != second_) {
      second_ = now / 1000;
      const std::time_t t = second_;
      std::tm m{};
      gmtime_r(&t, &m);
      second_text_ = fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.", m.tm_year + 1900, m.tm_mon + 1, m.tm_mday, m.tm_hour, m.tm_min, m.tm_sec);
    }
    char time[25];
    *fmt::format_to_n(time, sizeof time - 1, "{}{:03}Z", second_text_, now % 1000).out = '\0';
    append_log_line(lines_, format_, time, entry);
    much = lines_.size() >= kMuch;
  }
  if (much) flush();
}

// A log that can't be written (its reader went away, the disk is full) is lost: serving goes on.
void AccessLog::flush() {
  std::lock_guard writing(writing_);
  std::string lines;
  {
    std::lock_guard lock(mutex_);
    lines.swap(lines_);
  }
  for (std::string_view rest = lines; !rest.empty();) {
    const ssize_t n = ::write(descriptor_, rest.data(), rest.size());
    if (n < 0 && errno != EINTR) return;
    if (n > 0) rest.remove_prefix(static_cast<size_t>(n));
  }
}

}  // namespace teracell
