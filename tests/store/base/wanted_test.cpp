// Work that is stopped because nobody waits for it.
#include "store/base/wanted.hpp"

#include "store/base/in_order.hpp"
#include "store/base/lru_cache.hpp"
#include "store/read/stats.hpp"
#include "tests/support/stored.hpp"
#include "tests/support/test.hpp"

namespace teracell {
namespace {

void give_up() { throw Unwanted("gone"); }

TEST_CASE("Only the thread that says so is asked, the innermost first", "[wanted]") {
  Wanted::stop_if_not();
  int outer = 0;
  const Wanted a([&] { ++outer; });
  {
    const Wanted b(give_up);
    CHECK_THROWS_AS(Wanted::stop_if_not(), Unwanted);
    std::thread([] { Wanted::stop_if_not(); }).join();
  }
  Wanted::stop_if_not();
  CHECK(outer == 1);
}

TEST_CASE("Other threads ask for the one that they work for, when it says so; that one asks for itself", "[wanted][threads]") {
  const auto work = [] {
    int next = 0, done = 0;
    in_order(
        3, [&] { return next < 20 ? std::optional(next++) : std::nullopt; }, [](int job, int) { return Wanted::stop_if_not(), job; },
        [&](int) { ++done; });
    return done;
  };
  const auto caller = std::this_thread::get_id();
  std::atomic<int> asked = 0, wrong = 0;
  {
    const Wanted workers([&] { ++asked, wrong += std::this_thread::get_id() == caller; }, Wanted::Asked::kByWorkers);
    const Wanted here([&] { ++asked, wrong += std::this_thread::get_id() != caller; });
    CHECK(work() == 20);
  }
  CHECK(asked == 20);
  CHECK(wrong == 0);
  const Wanted workers(give_up, Wanted::Asked::kByWorkers);
  CHECK_THROWS_AS(work(), Unwanted);
}

TEST_CASE("When the thread that makes a value gives up, another one that waits for it makes it", "[wanted][lru_cache][threads]") {
  LruCache<int, int> cache(10000);
  std::atomic<bool> making = false, go = false;
  std::thread first([&] {
    CHECK_THROWS_AS(cache.get(1,
                              [&]() -> std::pair<std::shared_ptr<const int>, size_t> {
                                making = true;
                                while (!go) std::this_thread::yield();
                                throw Unwanted("gone");
                              }),
                    Unwanted);
  });
  while (!making) std::this_thread::yield();
  std::atomic<int> made = 0, right = 0;
  std::vector<std::thread> others;
  for (int i = 0; i < 3; ++i)
    others.emplace_back([&] {
      right += *cache.get(1, [&] {
        ++made;
        return std::pair(std::make_shared<const int>(7), size_t{1});
      }) == 7;
    });
  while (cache.counts().misses < 4) std::this_thread::yield();
  go = true;
  first.join();
  for (auto& t : others) t.join();
  CHECK(made == 1);
  CHECK(right == 3);
}

}  // namespace
}  // namespace teracell
