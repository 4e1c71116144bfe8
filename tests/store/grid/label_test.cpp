// Sets of labels and their ids.
#include "store/grid/label.hpp"

#include "tests/support/test.hpp"

namespace teracell {
namespace {

TEST_CASE("A label is the id of the set that has it alone, without an entry in the table") {
  SetTable table(5);
  for (Label label = 0; label < 5; ++label) {
    REQUIRE(table.intern({label}) == label);
    REQUIRE(table.members(label) == std::vector<Label>{label});
  }
  REQUIRE(table.ids() == 5);
}

TEST_CASE("Equal sets get one id, different sets different ones, and ids give their members back") {
  SetTable table(100);
  const SetId a = table.intern({1, 2}), b = table.intern({1, 2, 3}), c = table.intern({1, 99});
  REQUIRE(std::set<SetId>{a, b, c} == std::set<SetId>{100, 101, 102});
  REQUIRE(table.intern({1, 2}) == a);
  REQUIRE(table.intern({1, 99}) == c);
  REQUIRE(table.members(b) == std::vector<Label>{1, 2, 3});
  REQUIRE(table.ids() == 103);
}

TEST_CASE("A union has the members of both, whatever was asked before") {
  std::mt19937_64 random(1);
  constexpr uint32_t kLabels = 12;  // 4095 sets: far more pairs than the table remembers
  SetTable table(kLabels);
  for (int i = 0; i < 20'000; ++i) {
    const auto a = static_cast<SetId>(random() % table.ids()), b = static_cast<SetId>(random() % table.ids());
    const auto x = table.members(a), y = table.members(b);
    std::vector<Label> both;
    std::set_union(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(both));
    REQUIRE(table.members(table.unite(a, b)) == both);
  }
  REQUIRE(table.ids() <= (1u << kLabels) - 1);
}

TEST_CASE("A union is the same from either side and with a part of itself") {
  SetTable table(4);
  const SetId all = table.unite(table.unite(0, 1), table.unite(2, 3));
  REQUIRE(table.unite(1, 0) == table.unite(0, 1));
  REQUIRE(table.unite(all, 2) == all);
  REQUIRE(table.unite(all, all) == all);
  REQUIRE(table.members(all) == std::vector<Label>{0, 1, 2, 3});
}

TEST_CASE("A copy of a table goes its own way") {
  SetTable table(4);
  const SetId pair = table.unite(0, 1);
  SetTable copy = table;
  REQUIRE(copy.unite(0, 1) == pair);
  REQUIRE(copy.intern({2, 3}) == table.intern({1, 3}));
  REQUIRE(copy.members(copy.intern({2, 3})) == std::vector<Label>{2, 3});
  REQUIRE(table.members(table.intern({1, 3})) == std::vector<Label>{1, 3});
}

}  // namespace
}  // namespace teracell
