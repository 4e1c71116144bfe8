// The neighbours of a tile that was looked at, made while nobody waits.
#include "server/prefetch.hpp"

#include <algorithm>
#include <atomic>

#include <catch2/catch.hpp>

namespace teracell {
namespace {

using Targets = std::vector<std::string>;

Response tile() {
  Response r;
  r.route = "tile";
  return r;
}

// What was fetched, and a way to wait for it.
struct Fetched {
  std::mutex mutex;
  std::condition_variable changed;
  Targets all;
  size_t with_gzip = 0;
  void add(const Request& request) {
    std::lock_guard lock(mutex);
    all.push_back(request.target);
    with_gzip += request.accepts_gzip;
    changed.notify_all();
  }
  Targets wait_for(size_t count) {
    std::unique_lock lock(mutex);
    changed.wait_for(lock, std::chrono::seconds(20), [&] { return all.size() >= count; });
    Targets sorted = all;
    std::ranges::sort(sorted);
    return sorted;
  }
};

TEST_CASE("The neighbours of a tile are those of the slices before and behind", "[server]") {
  CHECK(neighbours("/api/v1/grids/g/tile/z/7/0/1_2.png?v=x") == Targets{"/api/v1/grids/g/tile/z/8/0/1_2.png?v=x", "/api/v1/grids/g/tile/z/6/0/1_2.png?v=x"});
  CHECK(neighbours("/api/v1/grids/g/tile/z/0/0/1_2.bin") == Targets{"/api/v1/grids/g/tile/z/1/0/1_2.bin"});
  for (const char* other : {"/", "", "/api/v1/grids/g", "/api/v1/grids/g/slice/z/7.png", "/api/v1/grids/g/tile/z/x/0/0_0.png", "/api/v1/grids/g/tile/z/7", "/zarr/g/tile/z/7/0/0_0.png", "/api/v1/grids/tile"})
    CHECK(neighbours(other).empty());
}

TEST_CASE("Neighbours are fetched once nothing is under way, and only of tiles that were there", "[server][threads]") {
  Fetched fetched;
  Prefetch prefetch([&](const Request& request) { fetched.add(request); });
  prefetch.begin();
  prefetch.begin();
  prefetch.answered({.target = "/api/v1/grids/g/tile/z/7/0/0_0.png"}, tile());
  Response missing = tile();
  missing.status = 404;
  prefetch.answered({.target = "/api/v1/grids/g/tile/z/70/0/0_0.png"}, missing);
  Response other = tile();
  other.route = "slice";
  prefetch.answered({.target = "/api/v1/grids/g/tile/z/80/0/0_0.png"}, other);
  prefetch.end();
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  {
    std::lock_guard lock(fetched.mutex);
    CHECK(fetched.all.empty());
  }
  prefetch.end();
  CHECK(fetched.wait_for(2) == Targets{"/api/v1/grids/g/tile/z/6/0/0_0.png", "/api/v1/grids/g/tile/z/8/0/0_0.png"});
}

TEST_CASE("Neighbours are asked for with gzip when the tile was", "[server][threads]") {
  Fetched fetched;
  Prefetch prefetch([&](const Request& request) { fetched.add(request); });
  prefetch.answered({.target = "/api/v1/grids/g/tile/z/7/0/0_0.bin", .accepts_gzip = true}, tile());
  fetched.wait_for(2);
  prefetch.answered({.target = "/api/v1/grids/g/tile/z/70/0/0_0.bin"}, tile());
  fetched.wait_for(4);
  CHECK(fetched.with_gzip == 2);
}

TEST_CASE("Of many that wait the latest are fetched, the oldest forgotten", "[server][threads]") {
  Fetched fetched;
  {
    Prefetch prefetch([&](const Request& request) { fetched.add(request); });
    prefetch.begin();
    for (int i = 1; i <= 1000; ++i) prefetch.answered({.target = "/api/v1/grids/g/tile/z/" + std::to_string(10 * i) + "/0/0_0.png"}, tile());
    prefetch.end();
    CHECK(fetched.wait_for(64).size() == 64);
  }
  CHECK(fetched.all.size() == 64);
  CHECK(fetched.all.front() == "/api/v1/grids/g/tile/z/9999/0/0_0.png");
}

}  // namespace
}  // namespace teracell
