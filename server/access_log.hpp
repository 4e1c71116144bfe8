// One line a request, gathered in memory: the warm path must not pay a system call for it.
#pragma once
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>

namespace teracell {

enum class LogFormat { kNone, kText, kJson };

struct LogEntry {
  std::string_view client, method, target;
  int status = 0;
  uint64_t bytes = 0;  // of the body
  double milliseconds = 0;
  std::string_view route;
};

// Appends the line. Whatever the client sent, nothing in it steers a terminal or ends a JSON string: bytes other than
// printable ASCII, quotes and backslashes come percent-encoded.
void append_log_line(std::string& out, LogFormat format, std::string_view time, const LogEntry& entry);

// Threads share it.
class AccessLog {
 public:
  AccessLog(LogFormat format, int descriptor) : format_(format), descriptor_(descriptor) {}
  ~AccessLog() { flush(); }
  AccessLog(const AccessLog&) = delete;
  AccessLog& operator=(const AccessLog&) = delete;

  void write(const LogEntry& entry);  // writes through when much has gathered
  void flush();                       // to be called every second or so

 private:
  static constexpr size_t kMuch = size_t{64} << 10;
  const LogFormat format_;
  const int descriptor_;
  std::mutex mutex_, writing_;
  std::string lines_, second_text_;
  int64_t second_ = 0;
};

}  // namespace teracell
