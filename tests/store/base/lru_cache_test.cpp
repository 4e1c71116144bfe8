// The cache: what is asked for stays, the rest makes room, whoever asks.
#include "store/base/lru_cache.hpp"

#include <atomic>
#include <thread>
#include <vector>

#include <catch2/catch.hpp>

namespace teracell {
namespace {

std::shared_ptr<const int> value(int v) { return std::make_shared<const int>(v); }

TEST_CASE("What was not asked for longest makes room; the bytes never pass the bound while there are two") {
  LruCache<uint64_t, int> cache(100);
  for (int i = 0; i < 10; ++i) cache.add(static_cast<uint64_t>(i), value(i), 10);
  REQUIRE(cache.counts().bytes == 100);
  REQUIRE(*cache.find(0) == 0);
  cache.add(10, value(10), 20);  // 1 and 2 go, 0 was just asked for
  REQUIRE(cache.counts().bytes == 100);
  REQUIRE(cache.find(0));
  REQUIRE_FALSE(cache.find(1));
  REQUIRE_FALSE(cache.find(2));
  REQUIRE(cache.find(3));
  cache.add(11, value(11), 1000);  // larger than the cache: it stays alone, until the next comes
  REQUIRE(cache.counts().bytes == 1000);
  REQUIRE(*cache.find(11) == 11);
  REQUIRE_FALSE(cache.find(0));
  cache.add(12, value(12), 1);
  REQUIRE(cache.counts().bytes == 1);
  REQUIRE_FALSE(cache.find(11));
  REQUIRE(cache.counts().hits == 4);
  REQUIRE(cache.counts().misses == 4);
}

TEST_CASE("A value stays for who holds it; a second one of the same key is not kept") {
  LruCache<uint64_t, int> cache(10);
  cache.add(1, value(1), 10);
  const auto held = cache.find(1);
  cache.add(1, value(-1), 10);
  REQUIRE(*cache.find(1) == 1);
  REQUIRE(cache.counts().bytes == 10);
  cache.add(2, value(2), 10);
  REQUIRE_FALSE(cache.find(1));
  REQUIRE(*held == 1);
}

TEST_CASE("What is erased makes room") {
  LruCache<uint64_t, int> cache(2);
  for (const int key : {1, 2}) cache.add(static_cast<uint64_t>(key), value(key), 1);
  cache.erase(1);
  cache.erase(7);
  REQUIRE(cache.counts().entries == 1);
  REQUIRE(cache.counts().bytes == 1);
  cache.add(3, value(3), 1);
  REQUIRE_FALSE(cache.find(1));
  REQUIRE(cache.find(2));
  REQUIRE(cache.find(3));
}

TEST_CASE("Threads share a cache", "[threads]") {
  LruCache<uint64_t, int> cache(64);
  std::vector<std::jthread> pool;
  std::atomic<int> wrong = 0;
  for (int t = 0; t < 4; ++t)
    pool.emplace_back([&, t] {
      for (int i = 0; i < 20'000; ++i) {
        const int key = (i * 7 + t * 13) % 100;
        if (const auto found = cache.find(static_cast<uint64_t>(key))) wrong += *found != key;
        else cache.add(static_cast<uint64_t>(key), value(key), 1);
      }
    });
  pool.clear();
  REQUIRE(wrong == 0);
  REQUIRE(cache.counts().bytes == 64);
}

}  // namespace
}  // namespace teracell
