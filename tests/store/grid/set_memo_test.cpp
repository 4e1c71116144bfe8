// What is known of sets, by their ids.
#include "store/grid/set_memo.hpp"

#include "tests/support/test.hpp"

namespace teracell {
namespace {

TEST_CASE("Each set is asked for once, whether there are few sets or many") {
  for (const uint32_t sets : {1u, 16u, 17u, 18u, 5000u}) {
    std::mt19937_64 random(sets);
    SetMemo<uint64_t> memo;
    std::map<SetId, uint64_t> expected;
    std::vector<uint64_t> in_order;
    size_t made = 0, wrong = 0;
    for (int i = 0; i < 20'000; ++i) {
      const auto set = static_cast<SetId>(random() % sets * 37);
      const uint64_t fresh = random();
      const auto [it, is_new] = expected.try_emplace(set, fresh);
      if (is_new) in_order.push_back(fresh);
      wrong += memo.get(set, [&] { return ++made, fresh; }) != it->second;
    }
    CHECK(wrong == 0);
    CHECK(made == expected.size());
    CHECK(memo.values() == in_order);
  }
}

}  // namespace
}  // namespace teracell
