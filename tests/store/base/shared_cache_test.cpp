// The cache that makes a value once however many ask, and forgets what was not asked for longest.
#include "store/base/shared_cache.hpp"

#include <atomic>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

namespace teracell {
namespace {

using Cache = SharedCache<std::string, int>;
std::pair<Cache::Pointer, size_t> made(int v, size_t bytes) { return {std::make_shared<const int>(v), bytes}; }

TEST_CASE("A value is made once and found again", "[shared_cache]") {
  Cache cache(10000);
  int times = 0;
  for (int i = 0; i < 3; ++i) CHECK(*cache.get("a", [&] { return made(++times, 100); }) == 1);
  CHECK(*cache.find("a") == 1);
  CHECK_FALSE(cache.find("b"));
  CHECK(cache.counts().misses == 1);
  CHECK(cache.counts().hits == 2);  // finding alone counts nothing
  cache.hit();
  CHECK(cache.counts().hits == 3);
  CHECK(cache.counts().entries == 1);
  CHECK(cache.counts().bytes > 100);
}

TEST_CASE("What was not asked for longest makes room, and the bytes never pass the limit", "[shared_cache]") {
  Cache cache(40000);
  const auto put = [&](const std::string& key) { cache.get(key, [] { return made(1, 8000); }); };
  for (const char* key : {"a", "b", "c", "d"}) put(key);
  REQUIRE(cache.counts().entries == 4);
  CHECK(cache.find("a"));
  put("e");
  CHECK(cache.find("a"));
  CHECK_FALSE(cache.find("b"));
  CHECK(cache.counts().bytes <= 40000);
  const auto held = cache.get("large", [] { return made(7, 50000); });
  CHECK(*held == 7);  // given, not kept
  CHECK_FALSE(cache.find("large"));
  CHECK(cache.find("a"));
}

TEST_CASE("While one thread makes a value the others wait for it", "[shared_cache][threads]") {
  Cache cache(1'000'000);  // room for all of them, also when a thread lags far behind
  std::atomic<int> times = 0, wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 8; ++t)
    threads.emplace_back([&] {
      for (int key = 0; key < 50; ++key) {
        const auto v = cache.get(std::to_string(key), [&] {
          ++times;
          std::this_thread::sleep_for(std::chrono::microseconds(200));
          return made(key, 1);
        });
        wrong += *v != key;
      }
    });
  for (auto& t : threads) t.join();
  CHECK(times == 50);
  CHECK(wrong == 0);
  CHECK(cache.counts().hits + cache.counts().misses == 400);
  CHECK(cache.counts().misses >= 50);  // who waited did not find it
}

TEST_CASE("A failure reaches all who wait for it and is not kept", "[shared_cache][threads]") {
  Cache cache(10000);
  std::atomic<int> times = 0, failed = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&] {
      try {
        cache.get("x", [&]() -> std::pair<Cache::Pointer, size_t> {
          ++times;
          std::this_thread::sleep_for(std::chrono::milliseconds(20));
          throw std::runtime_error("no");
        });
      } catch (const std::runtime_error&) {
        ++failed;
      }
    });
  for (auto& t : threads) t.join();
  CHECK(failed == 4);
  CHECK(times >= 1);
  CHECK(*cache.get("x", [] { return made(5, 1); }) == 5);
}

TEST_CASE("Threads that push each other's values out still get right ones", "[shared_cache][threads]") {
  Cache cache(3000);
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 3000; ++i) {
        const int key = (i * 7 + t * 13) % 40;
        wrong += *cache.get(std::to_string(key), [&] { return made(key, 100); }) != key;
        if (const auto found = cache.find(std::to_string(key))) wrong += *found != key;
      }
    });
  for (auto& t : threads) t.join();
  CHECK(wrong == 0);
  CHECK(cache.counts().bytes <= 3000);
}

}  // namespace
}  // namespace teracell
