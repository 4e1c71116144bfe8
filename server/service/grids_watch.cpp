#include "server/service/grids_watch.hpp"

#include <chrono>
#include <utility>

#include "store/base/wanted.hpp"

namespace teracell::server {
namespace {

constexpr auto kEvery = std::chrono::milliseconds(500);

}  // namespace

GridsWatch::GridsWatch(GridList& grids, double recheck) : grids_(grids), recheck_(recheck) {
  files_ = std::jthread([this](const std::stop_token& stop) { watch_files(stop); });
  if (grids_.has_addresses()) addresses_ = std::jthread([this](const std::stop_token& stop) { watch_addresses(stop); });
}

void GridsWatch::look_soon() {
  {
    std::lock_guard lock(waiting_);
    look_soon_ = recheck_soon_ = true;
  }
  woken_.notify_all();
}

void GridsWatch::watch_files(const std::stop_token& stop) {
  for (;;) {
    bool anew;
    {
      std::unique_lock lock(waiting_);
      woken_.wait_for(lock, stop, kEvery, [&] { return look_soon_; });
      anew = std::exchange(look_soon_, false);
    }
    if (stop.stop_requested()) return;
    try {
      grids_.look(anew);
    } catch (const std::exception&) {  // out of memory: what the last look found stays
    }
  }
}

void GridsWatch::watch_addresses(const std::stop_token& stop) {
  for (;;) {
    {
      std::unique_lock lock(waiting_);
      woken_.wait_for(lock, stop, std::chrono::duration<double>(recheck_), [&] { return recheck_soon_; });
      recheck_soon_ = false;
    }
    if (stop.stop_requested()) return;
    try {
      const Wanted until_stopped([&] {
        if (stop.stop_requested()) throw Unwanted("the server stops");
      });
      grids_.recheck();
    } catch (const std::exception&) {  // asked again next time
    }
  }
}

}  // namespace teracell::server
