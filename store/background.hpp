// Work handed to one other thread, done in order: reading goes on while what was read is studied.
#pragma once
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>

namespace teracell {

// run() and finish() are for one thread; run() waits while kMostWaiting jobs have not begun. What a job throws, the next
// run() or finish() throws; the jobs after it are dropped. The destructor drops what has not begun.
class Background {
 public:
  // Without a thread of its own, run() does the job itself.
  explicit Background(bool own_thread) {
    if (own_thread) thread_ = std::thread([this] { work(); });
  }
  ~Background() {
    if (!thread_.joinable()) return;
    {
      std::lock_guard lock(mutex_);
      jobs_.clear();
      closed_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  void run(std::function<void()> job) {
    if (!thread_.joinable()) return job();
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return jobs_.size() < kMostWaiting || error_; });
      if (error_) std::rethrow_exception(error_);
      jobs_.push_back(std::move(job));
    }
    changed_.notify_all();
  }
  // Waits until every job is done.
  void finish() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return (jobs_.empty() && !busy_) || error_; });
    if (error_) std::rethrow_exception(error_);
  }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    for (;;) {
      changed_.wait(lock, [&] { return closed_ || !jobs_.empty(); });
      if (jobs_.empty()) return;
      std::function<void()> job = std::move(jobs_.front());
      jobs_.pop_front();
      busy_ = true;
      lock.unlock();
      std::exception_ptr error;
      try {
        job();
      } catch (...) {
        error = std::current_exception();
      }
      job = nullptr;  // what it holds is freed now, not when the next one comes
      lock.lock();
      busy_ = false;
      if (error) {
        error_ = error;
        jobs_.clear();
        return changed_.notify_all();
      }
      if (jobs_.empty() || jobs_.size() + 1 == kMostWaiting) changed_.notify_all();
    }
  }

  static constexpr size_t kMostWaiting = 16;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> jobs_;
  std::exception_ptr error_;
  bool busy_ = false, closed_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace teracell
