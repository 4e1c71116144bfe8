// The log: one line per request, and notes. Lines are collected in memory and written by a thread of the log's own, so that no
// answer waits for a system call, or for a reader of the log that has stopped reading. When too many lines have been collected,
// further ones are dropped. The log says how many as soon as it can be written again.
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

namespace teracell::server {

enum class LogFormat { kNone, kText, kJson };  // kNone leaves out requests; notes are always written

struct LogEntry {
  std::string_view client, method, target;
  int status = 0;
  uint64_t bytes = 0;  // of the body that were sent
  double milliseconds = 0;
  std::string_view route;
  bool cut = false;  // the answer ended early because a part of it could not be made
};

// Appends the line. Nothing that a client sends can steer a terminal or end a JSON string: quotes, backslashes and all bytes
// that are not printable ASCII are percent-encoded.
void append_log_line(std::string& out, LogFormat format, std::string_view time, const LogEntry& entry);

// Threads share it.
class AccessLog {
 public:
  static constexpr size_t kMost = size_t{1} << 20;  // bytes of lines that are not written yet

  AccessLog(LogFormat format, int descriptor);
  ~AccessLog() { finish(); }
  AccessLog(const AccessLog&) = delete;
  AccessLog& operator=(const AccessLog&) = delete;

  void write(const LogEntry& entry) noexcept;
  void note(std::string_view message) noexcept;  // REQUIRES: no control characters in it
  uint64_t dropped() const { return dropped_; }  // lines since the start
  // When it returns, all lines are written, or given up because nobody read them for half a second. Later lines are dropped.
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
  std::chrono::steady_clock::time_point give_up_;  // set by finish()
  int64_t second_ = 0;
  std::array<char, 32> time_{};  // the text that time() returned last
  std::atomic<uint64_t> dropped_{0};
  std::thread thread_;  // last: it uses the others
};

}  // namespace teracell::server
