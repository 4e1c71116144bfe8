// Threads for requests that take long. Clients take turns, so that one with a thousand requests does not keep another one waiting. Each
// cost of work has a lane of its own, and where there are several threads no lane gets all of them: tiles wait neither for what is seen in
// three dimensions nor for dear work, and what is seen does not wait for dear work.
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

#include "server/service/handler.hpp"

namespace teracell::server {

class Pool {
 public:
  // With several threads, starts half as many again, for what is seen: the system shares the cores among them. Throws IoError when a thread
  // can't be started.
  explicit Pool(int threads);
  ~Pool() { join(); }
  // What `work` throws is lost. `client` tells one client from another. When it throws bad_alloc, nothing was posted.
  void post(const void* client, Cost cost, std::function<void()> work);
  void join();  // when everything posted so far is done

 private:
  // The work of one cost: a queue for each client, and the clients in the order of their turns.
  struct Lane {
    std::unordered_map<const void*, std::deque<std::function<void()>>> queues;
    std::list<const void*> turns;
    size_t running = 0, most = ~size_t{0};  // pieces of work at once
    bool empty() const { return turns.empty(); }
    std::function<void()> take();
  };
  Lane& lane(Cost cost) { return lanes_[static_cast<size_t>(cost)]; }
  bool has_waiting() const;
  Lane* next();
  void work();

  const bool several_;  // threads
  std::mutex mutex_;
  std::condition_variable changed_;
  std::array<Lane, 3> lanes_;  // by cost
  int cheap_in_a_row_ = 0;
  bool stopping_ = false;
  std::vector<std::jthread> threads_;  // last: they use the others
};

}  // namespace teracell::server
