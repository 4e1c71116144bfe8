// The neighbours of a tile that was looked at are fetched while nothing else is made.
#include "server/operations/prefetch.hpp"

#include "tests/support/test.hpp"

namespace teracell::server {
namespace {

using Targets = std::vector<std::string>;

Response tile() {
  Response r;
  r.route = "tile";
  return r;
}

// The targets that were fetched, and a way to wait for them.
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

TEST_CASE("The neighbours of a tile are the same tiles of the previous and the next slice", "[server]") {
  CHECK(neighbours("/api/v1/grids/g/tile/z/7/0/1_2.png?v=x") ==
        Targets{"/api/v1/grids/g/tile/z/8/0/1_2.png?v=x", "/api/v1/grids/g/tile/z/6/0/1_2.png?v=x"});
  CHECK(neighbours("/api/v1/grids/g/tile/z/0/0/1_2.bin") == Targets{"/api/v1/grids/g/tile/z/1/0/1_2.bin"});
  for (const char* other : {"/", "", "/api/v1/grids/g", "/api/v1/grids/g/slice/z/7.png", "/api/v1/grids/g/tile/z/x/0/0_0.png",
                            "/api/v1/grids/g/tile/z/7", "/zarr/g/tile/z/7/0/0_0.png", "/api/v1/grids/tile"})
    CHECK(neighbours(other).empty());
}

TEST_CASE("Neighbours are fetched once nothing is under way, and only those of tiles that exist", "[server][threads]") {
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

TEST_CASE("Neighbours are fetched with gzip when the tile was asked for with gzip", "[server][threads]") {
  Fetched fetched;
  Prefetch prefetch([&](const Request& request) { fetched.add(request); });
  prefetch.answered({.target = "/api/v1/grids/g/tile/z/7/0/0_0.bin", .accepts_gzip = true}, tile());
  fetched.wait_for(2);
  prefetch.answered({.target = "/api/v1/grids/g/tile/z/70/0/0_0.bin"}, tile());
  fetched.wait_for(4);
  CHECK(fetched.with_gzip == 2);
}

TEST_CASE("When many wait, the latest are fetched and the oldest are dropped", "[server][threads]") {
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

TEST_CASE("A handler with prefetch gives the inner answers, and has the neighbours of tiles fetched", "[server][threads]") {
  Fetched fetched;
  Prefetch prefetch([&](const Request& request) { fetched.add(request); });
  const std::string warm = "/api/v1/grids/g/tile/z/7/0/0_0.png", cold = "/api/v1/grids/g/tile/z/70/0/0_0.png";
  bool fetched_meanwhile = false;
  const Handler inner{[&](const Request& r) { return r.target == warm ? std::optional(tile()) : std::nullopt; },
                      [&](const Request& r) {
                        if (r.target == "/thrown") throw std::runtime_error("thrown");
                        prefetch.answered({.target = "/api/v1/grids/g/tile/z/700/0/0_0.png"}, tile());
                        std::lock_guard lock(fetched.mutex);
                        fetched_meanwhile = !fetched.all.empty();
                        return tile();
                      },
                      [](std::string_view path) { return path == "/open"; }};
  const Handler with = with_prefetch(inner, prefetch);
  CHECK_FALSE(with.at_once({.target = cold}));
  CHECK(with.handle({.target = cold}).route == std::string("tile"));
  CHECK_FALSE(fetched_meanwhile);
  fetched.wait_for(4);
  CHECK_THROWS_AS(with.handle({.target = "/thrown"}), std::runtime_error);  // prefetching must go on
  CHECK(with.at_once({.target = warm}));
  const Targets all = fetched.wait_for(6);
  REQUIRE(all.size() == 6);
  for (const char* index : {"6", "8", "69", "71", "699", "701"})
    CHECK(std::ranges::count(all, "/api/v1/grids/g/tile/z/" + std::string(index) + "/0/0_0.png") == 1);
  CHECK(with.is_open("/open"));
  CHECK_FALSE(with.is_open("/"));
}

}  // namespace
}  // namespace teracell::server
