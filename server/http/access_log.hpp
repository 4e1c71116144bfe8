// One line a request, and what else is to be said while serving. Lines are gathered in memory and written by a thread of
// its own: neither a system call nor a reader that has stopped reading costs an answer anything. When too much has gathered,
// lines are dropped; how many stands in the log once it moves again.
#pragma once
#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace teracell {

enum class LogFormat { kNone, kText, kJson };  // of requests; notes are written with kNone, too

struct LogEntry {
  std::string_view client, method, target;
  int status = 0;
  uint64_t bytes = 0;  // of the body, as far as they were sent
  double milliseconds = 0;
  std::string_view route;
};

// Appends the line. Whatever the client sent, nothing in it steers a terminal or ends a JSON string: bytes other than
// printable ASCII, quotes and backslashes come percent-encoded.
void append_log_line(std::string& out, LogFormat format, std::string_view time, const LogEntry& entry);

// Threads share it.
class AccessLog {
 public:
  static constexpr size_t kMost = size_t{1} << 20;  // bytes that may wait to be written

  AccessLog(LogFormat format, int descriptor);
  ~AccessLog() { finish(); }
  AccessLog(const AccessLog&) = delete;
  AccessLog& operator=(const AccessLog&) = delete;

  void write(const LogEntry& entry) noexcept;
  void note(std::string_view message) noexcept;  // REQUIRES: no control characters in it
  uint64_t dropped() const { return dropped_; }  // lines, ever
  // All that has gathered is written when it returns, or given up because nobody took it for two seconds. What comes later
  // is dropped.
  void finish();

 private:
  template <class Append>
  void add(Append append) noexcept;
  std::string_view time();  // REQUIRES: locked
  void work();
  void write_through(std::string_view lines);
  bool takes_some();

  const LogFormat format_;
  const int descriptor_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string lines_;
  std::atomic<bool> finished_{false};
  std::chrono::steady_clock::time_point give_up_;  // once finished
  int64_t second_ = 0;
  std::array<char, 32> time_{};  // the last one asked for
  std::atomic<uint64_t> dropped_{0};
  std::thread thread_;  // last: it uses the others
};

}  // namespace teracell
