// The cache: what is asked for stays, the rest makes room, whoever asks; and a value is made once however many ask.
#include "store/base/lru_cache.hpp"

#include "tests/support/test.hpp"

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

using Cache = LruCache<std::string, int>;
std::pair<Cache::Pointer, size_t> made(int v, size_t bytes) { return {std::make_shared<const int>(v), bytes}; }

TEST_CASE("A value is made once and found again", "[lru_cache]") {
  Cache cache(10000);
  int times = 0;
  for (int i = 0; i < 3; ++i) CHECK(*cache.get("a", [&] { return made(++times, 100); }) == 1);
  CHECK(*cache.peek("a") == 1);
  CHECK_FALSE(cache.peek("b"));
  CHECK(cache.counts().misses == 1);
  CHECK(cache.counts().hits == 2);  // a look alone counts nothing
  cache.hit();
  CHECK(cache.counts().hits == 3);
  CHECK(cache.counts().entries == 1);
  CHECK(cache.counts().bytes > 100);
}

TEST_CASE("What was not asked for longest makes room, and the bytes never pass the limit", "[lru_cache]") {
  Cache cache(40000);
  const auto put = [&](const std::string& key) { cache.get(key, [] { return made(1, 8000); }); };
  for (const char* key : {"a", "b", "c", "d"}) put(key);
  REQUIRE(cache.counts().entries == 4);
  CHECK(cache.peek("a"));
  put("e");
  CHECK(cache.peek("a"));
  CHECK_FALSE(cache.peek("b"));
  CHECK(cache.counts().bytes <= 40000);
  const auto held = cache.get("large", [] { return made(7, 50000); });
  CHECK(*held == 7);  // given, not kept
  CHECK_FALSE(cache.peek("large"));
  CHECK(cache.peek("a"));
}

TEST_CASE("While one thread makes a value the others wait for it", "[lru_cache][threads]") {
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

TEST_CASE("A failure reaches all who wait for it and is not kept", "[lru_cache][threads]") {
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

TEST_CASE("Threads that push each other's values out still get right ones", "[lru_cache][threads]") {
  Cache cache(3000);
  std::atomic<int> wrong = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      for (int i = 0; i < 3000; ++i) {
        const int key = (i * 7 + t * 13) % 40;
        wrong += *cache.get(std::to_string(key), [&] { return made(key, 100); }) != key;
        if (const auto found = cache.peek(std::to_string(key))) wrong += *found != key;
      }
    });
  for (auto& t : threads) t.join();
  CHECK(wrong == 0);
  CHECK(cache.counts().bytes <= 3000);
}

}  // namespace
}  // namespace teracell
