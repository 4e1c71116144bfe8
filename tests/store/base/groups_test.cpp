// Groups: the least thing stands for all that were joined, in whatever order.
#include "store/base/groups.hpp"

#include "tests/support/test.hpp"

namespace teracell {
namespace {

TEST_CASE("Things that were joined have one group, for which the least of them stands") {
  Groups groups(4);
  REQUIRE(groups.add() == 4);
  REQUIRE(groups.count() == 5);
  groups.join(4, 2);
  groups.join(3, 4);
  REQUIRE(groups.of(3) == 2);
  REQUIRE(groups.of(0) == 0);
  REQUIRE(groups.stands_for_one(2));
  REQUIRE_FALSE(groups.stands_for_one(4));
  groups.join(2, 3);  // once more
  REQUIRE(groups.count() == 3);
}

TEST_CASE("Groups are those of labels that are painted over at each join") {
  std::mt19937 random(7);
  for (uint32_t things = 1; things < 60; ++things) {
    Groups groups(things);
    std::vector<uint32_t> label(things);
    std::iota(label.begin(), label.end(), 0);
    const auto any = [&] { return static_cast<uint32_t>(random() % things); };
    const auto paint = [&](uint32_t a, uint32_t b) {
      const uint32_t low = std::min(label[a], label[b]), high = std::max(label[a], label[b]);
      std::ranges::replace(label, high, low);
    };
    for (uint32_t i = 0; i < things / 3; ++i) {
      const uint32_t a = any(), b = any(), c = any();
      paint(a, b);
      if (i % 2 == 0) groups.join(a, b);
      else groups.join(a, b, c), paint(a, c);
    }
    for (uint32_t thing = 0; thing < things; ++thing) REQUIRE(groups.of(thing) == label[thing]);
  }
}

}  // namespace
}  // namespace teracell
