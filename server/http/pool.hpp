// Threads for requests that take long. Clients take turns, so that one with a thousand requests does not keep another one waiting.
// Work is cheap (a tile) or dear (statistics of a region): where there are two threads or more, neither kind gets all of them.
#pragma once
#include <array>
#include <condition_variable>
#include <deque>
#include <functional>
#include <list>
#include <mutex>
#include <thread>
#include <unordered_map>
#include <vector>

namespace teracell {

class Pool {
 public:
  enum Cost { kCheap, kDear };

  explicit Pool(int threads);  // throws IoError when a thread can't be started
  ~Pool() { join(); }
  // What `work` throws is lost. `client` tells one client from another. When it throws bad_alloc, nothing was posted.
  void post(const void* client, Cost cost, std::function<void()> work);
  void join();  // when everything posted so far is done

 private:
  // The work of one cost: a queue for each client, and the clients in the order of their turns.
  struct Lane {
    std::unordered_map<const void*, std::deque<std::function<void()>>> queues;
    std::list<const void*> turns;
    size_t running = 0;
    bool empty() const { return turns.empty(); }
    std::function<void()> take();
  };
  Lane* next();
  void work();

  const bool several_;          // threads
  const size_t most_running_;  // pieces of dear work
  std::mutex mutex_;
  std::condition_variable changed_;
  std::array<Lane, 2> lanes_;
  int cheap_in_a_row_ = 0;
  bool stopping_ = false;
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace teracell
