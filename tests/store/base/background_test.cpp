#include "store/base/background.hpp"

#include "tests/support/test.hpp"

using namespace teracell;

TEST_CASE("jobs are done in order, on another thread or on this one", "[background][threads]") {
  for (const bool own_thread : {false, true}) {
    std::vector<int> done;
    Background work(own_thread);
    for (int i = 0; i < 100; ++i) work.run([&done, i] { done.push_back(i); });  // more than may wait
    work.finish();
    REQUIRE(done.size() == 100);
    CHECK(std::is_sorted(done.begin(), done.end()));
  }
}

TEST_CASE("work for later lets what is waited for pass", "[background][threads]") {
  std::vector<int> done;
  std::promise<void> go;
  Background work(true);
  work.run([&] { go.get_future().wait(); });
  work.run_later([&] { done.push_back(2); });
  work.run([&] { done.push_back(1); });
  go.set_value();
  work.finish_all();
  CHECK(done == std::vector{1, 2});
}

TEST_CASE("finish() waits for no work for later, and such work can be dropped", "[background][threads]") {
  std::promise<void> begun, go;
  int later = 0;
  Background work(true);
  work.run_later([&] {
    begun.set_value();
    go.get_future().wait();
    ++later;
  });
  auto held = std::make_shared<int>();  // by the second job
  const std::weak_ptr<int> waiting = held;
  work.run_later([&, held = std::move(held)] { ++later; });
  begun.get_future().wait();
  std::thread opener([&] {
    while (!waiting.expired()) std::this_thread::yield();
    go.set_value();
  });
  work.drop_later();
  opener.join();
  work.finish_all();
  CHECK(later == 1);
  int now = 0;
  work.run([&] { ++now; });
  work.finish();
  CHECK(now == 1);
}

TEST_CASE("a thread that waits does work for later meanwhile", "[background][threads]") {
  std::promise<void> go;
  std::thread::id on;
  Background work(true);
  work.run([&] { go.get_future().wait(); });
  work.run_later([&] {
    on = std::this_thread::get_id();
    go.set_value();
  });
  work.finish();
  CHECK(on == std::this_thread::get_id());
}

TEST_CASE("what work for later throws is not thrown before the job of the other thread is done", "[background][threads]") {
  std::promise<void> begun, go;
  std::atomic<bool> done = false;
  Background work(true);
  work.run([&] {
    begun.set_value();
    go.get_future().wait();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    done = true;
  });
  begun.get_future().wait();
  work.run_later([&] {
    go.set_value();
    throw std::runtime_error("no");
  });
  CHECK_THROWS_WITH(work.finish(), "no");
  CHECK(done);
}

TEST_CASE("what a job throws reaches the next call, and later jobs are not begun", "[background][threads]") {
  for (const bool later : {false, true}) {
    bool begun = false;
    Background work(true);
    const auto fails = [] { throw std::runtime_error("no"); };
    if (later) work.run_later(fails);
    else work.run(fails);
    CHECK_THROWS_WITH(work.finish_all(), "no");
    CHECK_THROWS_WITH(work.run([&] { begun = true; }), "no");
    CHECK_THROWS_WITH(work.run_later([&] { begun = true; }), "no");
    CHECK_FALSE(begun);
  }
}

TEST_CASE("a list of a job is not filled again before the job is done", "[background][threads]") {
  Background work(true);
  JobLists<std::vector<int>> lists;
  int wrong = 0;
  for (int i = 0; i < 2000; ++i) {
    const auto list = lists.next();
    CHECK(list->empty());
    list->assign(100, i);
    work.run([&wrong, i, list] { wrong += std::ranges::count(*list, i) != 100; });
  }
  work.finish();
  CHECK(wrong == 0);
}
