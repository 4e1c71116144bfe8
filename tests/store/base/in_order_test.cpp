// Work by several threads, taken in order.
#include "store/base/in_order.hpp"

#include "tests/support/test.hpp"

namespace teracell {
namespace {

// Sleeps for up to `most` microseconds, differently each time, so that threads overtake each other.
void dawdle(int most) {
  thread_local std::mt19937 random(std::random_device{}());
  std::this_thread::sleep_for(std::chrono::microseconds(std::uniform_int_distribution<>(0, most)(random)));
}

auto counting_to(int n) {
  return [n, next = 0]() mutable -> std::optional<int> { return next < n ? std::optional(next++) : std::nullopt; };
}

TEST_CASE("Results are taken in the order of the jobs, whoever made them", "[threads]") {
  for (int threads = 0; threads <= 8; ++threads) {
    std::vector<int> taken;
    in_order(
        threads, counting_to(200),
        [](int job, int) {
          dawdle(200);
          return job * 3;
        },
        [&](int result) { taken.push_back(result); });
    REQUIRE(taken.size() == 200);
    for (int i = 0; i < 200; ++i) REQUIRE(taken[static_cast<size_t>(i)] == 3 * i);
  }
}

TEST_CASE("No job at all, and fewer jobs than threads, end the loop", "[threads]") {
  for (int threads = 1; threads <= 8; ++threads)
    for (int jobs = 0; jobs <= 3; ++jobs) {
      int taken = 0;
      in_order(
          threads, counting_to(jobs), [](int job, int) { return job; }, [&](int) { ++taken; });
      REQUIRE(taken == jobs);
    }
}

TEST_CASE("A worker's number is its own: two makes never share one at a time", "[threads]") {
  for (int threads = 1; threads <= 8; ++threads) {
    std::vector<std::atomic<int>> busy(static_cast<size_t>(threads));
    std::atomic<int> wrong = 0;
    in_order(
        threads, counting_to(200),
        [&](int job, int worker) {
          if (worker < 0 || worker >= threads || busy[static_cast<size_t>(worker)]++ != 0) ++wrong;
          dawdle(50);
          --busy[static_cast<size_t>(worker)];
          return job;
        },
        [](int) {});
    REQUIRE(wrong == 0);
  }
}

TEST_CASE("Jobs run at once on as many threads as asked for", "[threads]") {
  // Each of four jobs waits for the other three: with fewer threads this would never end.
  std::atomic<int> arrived = 0;
  int taken = 0;
  in_order(
      4, counting_to(4),
      [&](int job, int) {
        ++arrived;
        while (arrived < 4) std::this_thread::yield();
        return job;
      },
      [&](int) { ++taken; });
  REQUIRE(taken == 4);
}

TEST_CASE("Threads run ahead of what is taken by twice their number at most", "[threads]") {
  for (int threads = 1; threads <= 8; ++threads) {
    std::atomic<int> started = 0, taken = 0, furthest = 0;
    in_order(
        threads, counting_to(100),
        [&](int job, int) {
          const int ahead = ++started - taken;
          for (int seen = furthest; ahead > seen && !furthest.compare_exchange_weak(seen, ahead);) {
          }
          return job;
        },
        [&](int) {
          dawdle(300);
          ++taken;
        });
    REQUIRE(furthest <= 2 * threads + 1);  // a job may start between the end of take() and our count of it
    REQUIRE(taken == 100);
  }
}

TEST_CASE("Jobs and results that can only be moved are moved", "[threads]") {
  int sum = 0, next = 0;
  in_order(
      3, [&]() -> std::optional<std::unique_ptr<int>> { return next < 50 ? std::optional(std::make_unique<int>(next++)) : std::nullopt; },
      [](std::unique_ptr<int> job, int) { return std::make_unique<int>(*job + 1); }, [&](std::unique_ptr<int> result) { sum += *result; });
  REQUIRE(sum == 50 * 51 / 2);
}

TEST_CASE("An exception of make ends the loop after the results before it were taken; the earliest job's wins", "[threads]") {
  for (int threads = 1; threads <= 8; ++threads)
    for (const int first : {0, 1, 7, 99}) {
      int taken = 0;
      const auto run = [&] {
        in_order(
            threads, counting_to(100),
            [&](int job, int) {
              if (job == first) dawdle(2000);  // later jobs fail first
              if (job >= first) throw std::runtime_error("job " + std::to_string(job));
              return job;
            },
            [&](int) { ++taken; });
      };
      REQUIRE_THROWS_WITH(run(), "job " + std::to_string(first));
      REQUIRE(taken == first);
    }
}

TEST_CASE("An exception of next ends the loop after the jobs before it were taken", "[threads]") {
  for (int threads = 1; threads <= 8; ++threads)
    for (const int last : {0, 1, 20}) {
      int taken = 0, next = 0, asked = 0;
      const auto run = [&] {
        in_order(
            threads,
            [&]() -> std::optional<int> {
              ++asked;
              if (next == last) throw std::runtime_error("no job " + std::to_string(next));
              return next++;
            },
            [](int job, int) {
              dawdle(300);
              return job;
            },
            [&](int) { ++taken; });
      };
      REQUIRE_THROWS_WITH(run(), "no job " + std::to_string(last));
      REQUIRE(taken == last);
      REQUIRE(asked == last + 1);  // not once more after it failed
    }
}

TEST_CASE("An exception of make of an earlier job wins over one of next", "[threads]") {
  for (int threads = 2; threads <= 8; ++threads) {
    int next = 0;
    const auto run = [&] {
      in_order(
          threads,
          [&]() -> std::optional<int> {
            if (next == 3) throw std::runtime_error("next");
            return next++;
          },
          [](int job, int) {
            if (job == 2) {
              dawdle(3000);
              throw std::runtime_error("make");
            }
            return job;
          },
          [](int) {});
    };
    REQUIRE_THROWS_WITH(run(), "make");
  }
}

TEST_CASE("An exception of take ends the loop, though all threads wait for room", "[threads]") {
  for (int threads = 1; threads <= 8; ++threads)
    for (const int last : {0, 5}) {
      const auto run = [&] {
        in_order(
            threads, counting_to(1'000'000), [](int job, int) { return job; },
            [&](int result) {
              dawdle(1000);
              if (result == last) throw std::runtime_error("take " + std::to_string(result));
            });
      };
      REQUIRE_THROWS_WITH(run(), "take " + std::to_string(last));
    }
}

TEST_CASE("What is done aside holds up no result, and all of it has been done in the end", "[threads]") {
  const auto caller = std::this_thread::get_id();
  std::atomic<int> begun = 0, taken = 0, done = 0;
  const auto make = [&](int job, int) {
    while (begun == 0) std::this_thread::yield();  // until one of the other threads is there
    return job;
  };
  const auto aside = [&]() -> Aside {
    if (begun == 2 || std::this_thread::get_id() == caller) return nullptr;
    return [&, first = begun++ == 0] {
      while (first && taken < 100) std::this_thread::yield();  // far more than may wait for their turn
      ++done;
    };
  };
  in_order(
      3, counting_to(300), make, [&](int) { ++taken; }, 2, nullptr, aside);
  CHECK(taken == 300);
  CHECK(done == begun);
}

TEST_CASE("An exception of asking what there is aside is that of the job that would be next", "[threads]") {
  for (int threads = 2; threads <= 4; ++threads) {
    int taken = 0, asked = 0;
    REQUIRE_THROWS_WITH(in_order(
                            threads, counting_to(100), [](int job, int) { return job; }, [&](int) { ++taken; }, 2, nullptr,
                            [&]() -> Aside {
                              if (++asked == 20) throw std::runtime_error("no memory");
                              return nullptr;
                            }),
                        "no memory");
    CHECK(taken <= 19);  // one who asked may find no room for its job
  }
}

TEST_CASE("A thread that has other work to do first is a worker afterwards, in place of a new one", "[threads]") {
  for (int threads = 2; threads <= 4; ++threads) {
    Background idle(true);
    std::promise<void> go;
    std::thread::id its_thread;
    idle.run_later([&] {
      its_thread = std::this_thread::get_id();
      go.get_future().wait();
    });
    std::atomic<bool> joined = false;
    int taken = 0, wrong = 0;
    in_order(
        threads, [n = 0, &joined]() mutable { return joined || n == 1'000'000 ? std::nullopt : std::optional(n++); },
        [&](int job, int worker) {
          if (job == 100) go.set_value();
          if (job > 100) std::this_thread::yield();
          const bool is_its = worker == threads - 1;
          if (is_its) joined = true;
          return std::pair(job, !is_its || std::this_thread::get_id() == its_thread);
        },
        [&](std::pair<int, bool> result) { wrong += result != std::pair(taken++, true); }, 2, &idle);
    REQUIRE(taken > 100);
    REQUIRE(joined);
    REQUIRE(wrong == 0);
    std::thread::id again;
    idle.run([&] { again = std::this_thread::get_id(); });
    idle.finish();
    REQUIRE(again == its_thread);
  }
}

TEST_CASE("A loop waits for no thread that is still at other work, whether it fails or not", "[threads]") {
  for (const bool fails : {false, true}) {
    std::promise<void> go;
    Background idle(true);
    bool done = false;
    idle.run_later([&, may_go = go.get_future().share()] {
      may_go.wait();
      done = true;
    });
    int taken = 0;
    bool failed = false;
    try {
      in_order(
          2, counting_to(50), [](int job, int) { return job; },
          [&](int) {
            if (++taken == 20 && fails) throw std::runtime_error("take");
          },
          2, &idle);
    } catch (const std::runtime_error&) {
      failed = true;
    }
    const bool before = done;
    go.set_value();
    idle.finish_all();
    REQUIRE(!before);
    REQUIRE(done);
    REQUIRE(failed == fails);
    REQUIRE(taken == (fails ? 20 : 50));
  }
}

TEST_CASE("What a thread's other work throws is thrown by its next call, not by the loop", "[threads]") {
  for (const int before : {0, 2000}) {
    Background idle(true);
    idle.run_later([] { throw std::runtime_error("count"); });
    dawdle(before);
    int taken = 0;
    in_order(
        2, counting_to(50),
        [](int job, int) {
          dawdle(100);
          return job;
        },
        [&](int result) { REQUIRE(result == taken++); }, 2, &idle);
    REQUIRE(taken == 50);
    REQUIRE_THROWS_WITH(idle.finish_all(), "count");
  }
}

TEST_CASE("A thousand short loops end: no wake-up is lost", "[threads]") {
  Background idle(true), without_thread(false);
  for (int round = 0; round < 1000; ++round) {
    const int threads = 1 + round % 8, jobs = round % 23;
    int sum = 0;
    in_order(
        threads, counting_to(jobs), [](int job, int) { return job; }, [&](int result) { sum += result; }, 2,
        std::array<Background*, 3>{nullptr, &idle, &without_thread}[static_cast<size_t>(round % 3)]);
    REQUIRE(sum == jobs * (jobs - 1) / 2);
  }
}

}  // namespace
}  // namespace teracell
