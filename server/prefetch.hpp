// The slices next to one that was looked at are made while nobody waits for anything: scrolling then finds them ready.
#pragma once
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "server/http.hpp"

namespace teracell {

// The targets of the tiles before and behind that of `target` ("/api/v1/grids/{id}/tile/{axis}/{index}/..."); empty for other
// targets. The one behind may not exist.
std::vector<std::string> neighbours(const std::string& target);

// Threads share it.
class Prefetch {
 public:
  // `fetch` makes the answer to a request and keeps it; it is called on a thread of its own.
  explicit Prefetch(std::function<void(const Request&)> fetch);
  ~Prefetch();  // waits for the one under way
  Prefetch(const Prefetch&) = delete;

  // Around the making of an answer: nothing is fetched ahead meanwhile.
  void begin();
  void end();
  // The neighbours are asked for as the request was: with gzip, or without.
  void answered(const Request& request, const Response& response);

 private:
  static constexpr size_t kMostWaiting = 64;  // then the oldest are forgotten: the user has scrolled on
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

}  // namespace teracell
