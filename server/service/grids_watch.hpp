// Looks at the files of the grids that are served twice per second, and asks the hosts of those behind addresses now and then, on threads of
// its own.
#pragma once
#include <condition_variable>
#include <mutex>
#include <thread>

#include "server/service/grids.hpp"

namespace teracell::server {

class GridsWatch {
 public:
  // `recheck`: seconds between two questions to the host of an address. REQUIRES: the grids outlive it.
  explicit GridsWatch(GridList& grids, double recheck = 60);
  // Makes it look anew now. Returns at once. From any thread.
  void look_soon();

 private:
  void watch_files(const std::stop_token& stop);
  void watch_addresses(const std::stop_token& stop);

  GridList& grids_;
  const double recheck_;
  std::mutex waiting_;  // guards the next two
  std::condition_variable_any woken_;
  bool look_soon_ = false, recheck_soon_ = false;
  std::jthread files_, addresses_;  // last: they use the others
};

}  // namespace teracell::server
