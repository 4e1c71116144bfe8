// Sums of what lies between sample points.
#include "mesher/thin/tally.hpp"

#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

bool same(const Tally& a, const Tally& b) {
  return a.number == b.number && a.length == b.length && a.widest == b.widest && a.from == b.from && a.cell == b.cell;
}
bool same(const Tallies& a, const Tallies& b) {
  return std::ranges::equal(a.all(), b.all(), [](const auto& x, const auto& y) { return x.first == y.first && same(x.second, y.second); });
}

TEST_CASE("A tally counts all and keeps the longest, of equals the one with the least z, then y, then x") {
  Tally sum{1, 0.5, 5, 7, {9, 9, 9}};
  sum.add({2, 0.4, 9, 1, {0, 0, 0}});  // more sub-positions, of a narrower cell
  CHECK(same(sum, {3, 0.5, 5, 7, {9, 9, 9}}));
  sum.add({1, 0.6, 2, 2, {8, 8, 8}});
  CHECK(same(sum, {4, 0.6, 2, 2, {8, 8, 8}}));
  sum.add({1, 0.6, 6, 3, {0, 0, 9}});
  CHECK(sum.cell == Index3{8, 8, 8});
  sum.add({1, 0.6, 6, 3, {0, 9, 8}});
  CHECK(sum.cell == Index3{8, 8, 8});
  sum.add({1, 0.6, 6, 3, {9, 7, 8}});
  CHECK(sum.cell == Index3{9, 7, 8});
  sum.add({1, 0.6, 6, 4, {9, 9, 7}});
  CHECK(same(sum, {8, 0.6, 6, 4, {9, 9, 7}}));
}

std::vector<std::pair<TallyKey, Tally>> some_tallies() {
  std::mt19937_64 random(1);
  std::vector<std::pair<TallyKey, Tally>> out;
  for (int i = 0; i < 300; ++i) {
    const auto small = [&](uint64_t below) { return static_cast<uint32_t>(random() % below); };
    const TallyKey key{static_cast<TallyKey::What>(small(4)), small(3), static_cast<uint8_t>(small(3))};
    // Within a key, a place has one width.
    const Index3 cell{small(4), small(4), int64_t{1} << small(31)};
    out.push_back(
        {key, {uint64_t{1} << small(60), 0.25 * static_cast<double>(cell[0]), static_cast<uint32_t>(cell[0]), static_cast<uint32_t>(cell[1]), cell}});
  }
  return out;
}

TEST_CASE("Sums do not depend on the order, nor on what was summed before") {
  auto all = some_tallies();
  Tallies expected;
  for (const auto& [key, tally] : all) expected.add(key, tally);
  std::mt19937_64 random(2);
  for (int order = 0; order < 5; ++order) {
    std::ranges::shuffle(all, random);
    std::array<Tallies, 3> parts;
    for (size_t i = 0; i < all.size(); ++i) parts[i % 3].add(all[i].first, all[i].second);
    parts[1].add(parts[2]);
    parts[0].add(parts[1]);
    REQUIRE(same(parts[0], expected));
  }
}

TEST_CASE("What is not tallied is not found, what is differs by kind, body and axis") {
  Tallies tallies;
  const TallyKey key{TallyKey::What::kGaps, 2, 1};
  CHECK(tallies.find(key) == nullptr);
  tallies.add(key, {3, 4, 5, 6, {7, 8, 9}});
  REQUIRE(tallies.find(key) != nullptr);
  CHECK(same(*tallies.find(key), {3, 4, 5, 6, {7, 8, 9}}));
  for (const TallyKey& other :
       {TallyKey{TallyKey::What::kStretches, 2, 1}, TallyKey{TallyKey::What::kGaps, 3, 1}, TallyKey{TallyKey::What::kGaps, 2, 0}})
    CHECK(tallies.find(other) == nullptr);
}

TEST_CASE("Tallies that are saved come back") {
  Tallies tallies;
  for (const auto& [key, tally] : some_tallies()) tallies.add(key, tally);
  for (const Tallies& some : {Tallies(), tallies}) {
    Bytes bytes;
    some.save(bytes);
    ByteReader in(bytes, "tallies");
    REQUIRE(same(Tallies::restored(in), some));
    REQUIRE(in.remaining() == 0);
  }
}

TEST_CASE("Sub-positions go from one sample point to the next, both included, and ascend") {
  for (const Axis& axis : {Axis::uniform(0.1, 0.3, 0, 3, 0.5), Axis::graded({0.1, 0.3, 0.7, 1.9}, 0.5)})
    for (int64_t i = 0; i < 2; ++i) {
      CHECK(sub_position(axis, i, 0) == axis.centre(i));
      CHECK(sub_position(axis, i, kSubPositions) == axis.centre(i + 1));
      for (uint32_t k = 1; k <= kSubPositions; k += 97) REQUIRE(sub_position(axis, i, k) > sub_position(axis, i, k - 1));
    }
  const Axis axis = Axis::uniform(0, 2, 0, 3, 0.5);
  CHECK(sub_position(axis, 1, kSubPositions / 4) == 3.5);
}

TEST_CASE("A tally's place is the middle of the widest, on its axis; so many sub-positions of a cell are a length") {
  const Grid grid{{Axis::uniform(0, 2, 0, 4, 0.5), Axis::uniform(10, 1, 0, 4, 0.5), Axis::graded({0, 1, 2, 8}, 0.5)}};
  const Tally tally{5, 1, kSubPositions / 2, kSubPositions / 4, {1, 2, 1}};
  const auto place = [&](TallyKey::What what, uint8_t axis) { return place_of({what, 0, axis}, tally, grid); };
  CHECK(place(TallyKey::What::kStretches, 0) == Vec3{4, 12.5, 1.5});
  CHECK(place(TallyKey::What::kGaps, 2) == Vec3{3, 12.5, 3.25});  // between 1.5 and 5
  CHECK(place(TallyKey::What::kLowerSide, 1) == Vec3{3, 10, 1.5});
  CHECK(length_of(grid.axis[0], 1, kSubPositions / 2) == 1);
  CHECK(length_of(grid.axis[2], 1, kSubPositions / 2) == 1.75);
}

}  // namespace
}  // namespace teracell::mesher
