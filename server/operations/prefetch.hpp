// Makes the slices next to one that was looked at while the server has nothing else to make, so that scrolling finds them in the
// cache.
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/service/handler.hpp"

namespace teracell::server {

// The targets of the same tile in the next and in the previous slice, for a target "/api/v1/grids/{id}/tile/{axis}/{index}/...";
// empty for other targets. The next slice may not exist.
std::vector<std::string> neighbours(const std::string& target);

// Threads share it.
class Prefetch {
 public:
  // `fetch` makes the answer to a request and keeps it. It is called on a thread of its own.
  explicit Prefetch(std::function<void(const Request&)> fetch);
  ~Prefetch();  // waits until a running fetch() returns
  Prefetch(const Prefetch&) = delete;

  // Around the making of an answer: nothing is prefetched in between.
  void begin();
  void end();
  // Queues the neighbours, to be asked for as the request was: with gzip or without.
  void answered(const Request& request, const Response& response);

 private:
  static constexpr size_t kMostWaiting = 64;  // then the oldest are dropped: the user has scrolled on
  void work();

  const std::function<void(const Request&)> fetch_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Request> waiting_;
  std::string last_;  // target
  int under_way_ = 0;
  bool closed_ = false;
  std::thread thread_;  // last: it uses the others
};

// `inner`, telling `prefetch` what it makes and answers. REQUIRES: `prefetch` outlives it.
Handler with_prefetch(Handler inner, Prefetch& prefetch);

}  // namespace teracell::server
