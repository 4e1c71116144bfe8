// Work that is handed to another thread and done in order: reading goes on while what was read is studied.
#pragma once
#include <array>
#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace teracell::inline store {

// One thread may call it. When a job throws, the next call throws the same and the jobs after it are dropped. The destructor
// drops the jobs that have not begun. No call throws what a job threw while a job of run() is being done, so such a job may use what lives where it
// was handed over until finish() has returned or thrown.
class Background {
 public:
  using Job = std::function<void()>;

  // Without a thread of its own, the calling thread does each job at once.
  explicit Background(bool own_thread) {
    if (own_thread) thread_ = std::thread([this] { work(); });
  }
  ~Background() {
    if (!thread_.joinable()) return;
    {
      std::lock_guard lock(mutex_);
      jobs_.clear();
      later_.clear();
      closed_ = true;
    }
    changed_.notify_all();
    thread_.join();
  }

  bool has_thread() const { return thread_.joinable(); }

  // Hands over a job. Waits while kMostWaiting such jobs have not begun.
  static constexpr size_t kMostWaiting = 16;
  void run(Job job) {
    if (!thread_.joinable()) return job();
    wait([&] { return jobs_.size() < kMostWaiting; }, [&] { jobs_.push_back(std::move(job)); });
    changed_.notify_all();
  }
  // Hands over a job that nothing waits for yet. It begins when no job of run() is left, or on the thread that waits for these in finish(), which
  // then may return one such job late. No two of them are done at once. (On a thread of their own they slowed reading down where there are only two
  // cores.)
  void run_later(Job job) {
    if (!thread_.joinable()) return job();
    wait([] { return true; }, [&] { later_.push_back(std::move(job)); });
    changed_.notify_all();
  }
  // Waits until every job of run() is done, and does jobs of run_later() meanwhile.
  void finish() {
    for (bool done = false; !done;) {
      Job job;
      wait([&] { return is_finished() || may_begin_later(); },
           [&] {
             done = is_finished();
             if (!done) job = take(later_), doing_later_ = true;
           });
      if (job) end(do_now(job), doing_later_);
    }
  }
  // Waits until every job is done.
  void finish_all() {
    wait([&] { return jobs_.empty() && later_.empty() && !doing_ && !doing_later_; }, [] {});
  }
  // Drops the jobs of run_later() that have not begun and waits for the one that has. Throws nothing.
  void drop_later() {
    std::unique_lock lock(mutex_);
    later_.clear();
    changed_.wait(lock, [&] { return !doing_later_; });
  }

 private:
  bool is_finished() const { return jobs_.empty() && !doing_; }
  bool may_begin_later() const { return !later_.empty() && !doing_later_; }
  static Job take(std::deque<Job>& queue) {
    Job job = std::move(queue.front());
    queue.pop_front();
    return job;
  }
  // Does a job, and frees what it holds. Returns what it threw.
  static std::exception_ptr do_now(Job& job) {
    std::exception_ptr error;
    try {
      job();
    } catch (...) {
      error = std::current_exception();
    }
    job = nullptr;
    return error;
  }
  // Of a job that this thread did.
  void end(const std::exception_ptr& error, bool& doing) {
    std::lock_guard lock(mutex_);
    doing = false;
    if (error) {
      if (!error_) error_ = error;
      jobs_.clear();
      later_.clear();
    }
    changed_.notify_all();
  }

  template <class Ready, class Then>
  void wait(Ready&& ready, Then&& then) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return error_ ? !doing_ : ready(); });
    if (error_) std::rethrow_exception(error_);
    then();
  }

  void work() {
    for (;;) {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return closed_ || error_ || !jobs_.empty() || may_begin_later(); });
      if (jobs_.empty() && !may_begin_later()) return;
      const bool later = jobs_.empty();
      bool& doing = later ? doing_later_ : doing_;
      Job job = take(later ? later_ : jobs_);
      doing = true;
      lock.unlock();
      end(do_now(job), doing);
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> jobs_, later_;
  std::exception_ptr error_;
  bool doing_ = false, doing_later_ = false;  // a job of run(), or of run_later(), is being done
  bool closed_ = false;
  std::thread thread_;  // last: it uses the others
};

// Lists for jobs of Background::run(), one for each job, used again and again: pages that are new to each job took half of the time of reading.
template <class List>
class JobLists {
 public:
  // An empty list for the next job. REQUIRES: the job for the list before it was handed over.
  std::shared_ptr<List> next() {
    List& list = (*lists_)[turn_++ % lists_->size()];
    list.clear();
    return {lists_, &list};
  }

 private:
  // When a job is handed over, as many may wait, the one before them may be at work, and one more list is filled.
  using Lists = std::array<List, Background::kMostWaiting + 2>;
  std::shared_ptr<Lists> lists_ = std::make_shared<Lists>();
  size_t turn_ = 0;
};

}  // namespace teracell::store
