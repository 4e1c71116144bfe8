// Threads that clients share in turns, for cheap and for dear work.
#include "server/http/pool.hpp"

#include "tests/support/failing_new.hpp"
#include "tests/support/test.hpp"

namespace teracell::server {
namespace {

// Work that waits until it is let go, and a list of what was done.
class Course {
 public:
  std::function<void()> note(const std::string& name) {
    return [=, this] {
      std::lock_guard lock(mutex_);
      done_ += name;
    };
  }
  std::function<void()> block() {
    return [this] {
      std::unique_lock lock(mutex_);
      ++blocked_;
      changed_.notify_all();
      changed_.wait(lock, [&] { return open_; });
    };
  }
  void wait_for_blocked(int n) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return blocked_ >= n; });
  }
  void open() {
    std::lock_guard lock(mutex_);
    open_ = true;
    changed_.notify_all();
  }
  std::string done() {
    std::lock_guard lock(mutex_);
    return done_;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::string done_;
  int blocked_ = 0;
  bool open_ = false;
};

const int kA = 0, kB = 0, kC = 0;  // clients

TEST_CASE("Clients take turns, whatever one of them has queued", "[pool][threads]") {
  Course course;
  Pool pool(1);
  pool.post(&kC, Cost::kCheap, course.block());
  course.wait_for_blocked(1);
  for (int i = 0; i < 4; ++i) pool.post(&kA, Cost::kCheap, course.note("a"));
  for (int i = 0; i < 2; ++i) pool.post(&kB, Cost::kCheap, course.note("b"));
  course.open();
  pool.join();
  CHECK(course.done() == "ababaa");
}

TEST_CASE("On one thread cheap work goes before dear work, which still gets its turn", "[pool][threads]") {
  Course course;
  Pool pool(1);
  pool.post(&kC, Cost::kCheap, course.block());
  course.wait_for_blocked(1);
  for (int i = 0; i < 2; ++i) pool.post(&kA, Cost::kDear, course.note("D"));
  for (int i = 0; i < 12; ++i) pool.post(&kB, Cost::kCheap, course.note("c"));
  course.open();
  pool.join();
  CHECK(course.done() == "cccccccDcccccD");  // the work that blocked was the first cheap one of eight
}

TEST_CASE("Dear work leaves a thread to cheap work", "[pool][threads]") {
  Course course;
  Pool pool(3);
  for (int i = 0; i < 10; ++i) pool.post(&kA, Cost::kDear, course.block());
  course.wait_for_blocked(2);
  std::atomic<bool> done = false;
  pool.post(&kB, Cost::kCheap, [&] { done = true; });
  while (!done) std::this_thread::yield();  // would never end if a third dear one had begun
  course.open();
  pool.join();
}

TEST_CASE("Cheap work leaves a thread to dear work", "[pool][threads]") {
  Course course;
  Pool pool(2);
  pool.post(&kC, Cost::kCheap, course.block());
  course.wait_for_blocked(1);
  std::atomic<int> cheap = 0;
  std::atomic<bool> dear = false;
  std::function<void()> again = [&] {  // there is always cheap work
    ++cheap;
    if (!dear) pool.post(&kB, Cost::kCheap, again);
  };
  again();
  pool.post(&kA, Cost::kDear, [&] { dear = true; });
  while (!dear) std::this_thread::yield();
  course.open();
  pool.join();
  CHECK(cheap > 0);
}

TEST_CASE("What is seen waits for neither dear nor cheap work, and leaves threads to both", "[pool][threads]") {
  Course course;
  Pool pool(2);
  for (int i = 0; i < 10; ++i) pool.post(&kA, Cost::kDear, course.block());
  for (int i = 0; i < 10; ++i) pool.post(&kB, Cost::kSeen, course.block());
  course.wait_for_blocked(2);
  std::atomic<bool> done = false;
  pool.post(&kC, Cost::kCheap, [&] { done = true; });
  while (!done) std::this_thread::yield();  // would never end if the blocked ones had all threads
  course.open();
  pool.join();

  Course dear;
  Pool other(2);
  for (int i = 0; i < 10; ++i) other.post(&kA, Cost::kDear, dear.block());
  dear.wait_for_blocked(1);
  std::atomic<bool> seen = false;
  other.post(&kB, Cost::kSeen, [&] { seen = true; });
  while (!seen) std::this_thread::yield();
  dear.open();
  other.join();
}

TEST_CASE("Joining does all that was posted", "[pool][threads]") {
  std::atomic<int> done = 0;
  {
    Pool pool(4);
    for (int i = 0; i < 1000; ++i) pool.post(&done + i % 7, static_cast<Cost>(i % 3), [&] { ++done; });
  }
  CHECK(done == 1000);
}

TEST_CASE("Work that could not be posted for want of memory is not done, and that posted later is", "[server][threads]") {
  const int client = 0;
  for (int fails = 0; fails < 6; ++fails) {
    INFO(fails);
    std::atomic<int> done = 0;
    bool posted = true;
    {
      Pool pool(2);
      std::function<void()> work = [&] { ++done; };
      allocations_left = fails;
      try {
        pool.post(&client, Cost::kDear, std::move(work));
      } catch (const std::bad_alloc&) {
        posted = false;
      }
      allocations_left = -1;
      pool.post(&client, Cost::kDear, [&] { ++done; });
    }
    CHECK(done == 1 + posted);
  }
}

}  // namespace
}  // namespace teracell::server
