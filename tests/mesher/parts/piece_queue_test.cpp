// Which process makes which piece.
#include "mesher/parts/piece_queue.hpp"
#include "tests/support/test.hpp"

namespace teracell::mesher {
namespace {

std::vector<uint32_t> first_pieces(uint32_t n) {
  std::vector<uint32_t> out(n);
  std::iota(out.begin(), out.end(), 0u);
  return out;
}

}  // namespace

TEST_CASE("Each piece is handed out once, within its home and in order, whoever asks when", "[parts]") {
  std::mt19937_64 random(11);
  for (int round = 0; round < 200; ++round) {
    const auto processes = static_cast<uint32_t>(1 + random() % 9);
    std::vector<uint32_t> pieces;
    for (uint32_t piece = 0; piece < 100; ++piece)
      if (random() % 3 != 0) pieces.push_back(piece);
    PieceQueue queue(pieces, processes);
    std::vector<std::optional<PieceQueue::Order>> last(processes);
    std::vector<bool> done(processes, false);
    std::vector<uint32_t> given;
    while (std::ranges::count(done, false) > 0) {
      const auto process = static_cast<uint32_t>(random() % (random() % processes + 1));  // the first ones ask more often
      const auto order = queue.next(process);
      if (!order) {
        done[process] = true;
        continue;
      }
      REQUIRE_FALSE(done[process]);
      REQUIRE((order->first <= order->piece && order->piece < order->end));
      if (last[process] && last[process]->first == order->first && last[process]->end == order->end) REQUIRE(last[process]->piece < order->piece);
      last[process] = order;
      given.push_back(order->piece);
    }
    std::ranges::sort(given);
    REQUIRE(given == pieces);
  }
}

TEST_CASE("Processes that are as fast as each other stay at home", "[parts]") {
  PieceQueue queue(first_pieces(40), 4);
  for (uint32_t i = 0; i < 10; ++i)
    for (uint32_t process = 0; process < 4; ++process) {
      const auto order = queue.next(process);
      REQUIRE(order);
      CHECK(order->piece == 10 * process + i);
      CHECK(order->first == 10 * process);
      CHECK(order->end == 10 * process + 10);
    }
  CHECK_FALSE(queue.next(0));
}

TEST_CASE("One process alone does the work of others that never ask, in few homes", "[parts]") {
  PieceQueue queue(first_pieces(1000), 8);
  std::set<uint32_t> pieces, homes;
  while (const auto order = queue.next(3)) pieces.insert(order->piece), homes.insert(order->first);
  CHECK(pieces.size() == 1000);
  CHECK(homes.size() < 8 * 10);
}

TEST_CASE("The last pieces are handed out from the costliest on, as many as there are processes", "[parts]") {
  std::vector<uint32_t> pieces = first_pieces(10);
  const uint64_t costs[] = {9, 1, 8, 2, 5, 7, 3, 7, 9, 4};
  last_by_cost(pieces, 4, [&](uint32_t piece) { return costs[piece]; });
  CHECK(pieces == std::vector<uint32_t>{0, 1, 2, 3, 4, 5, 8, 7, 9, 6});
  PieceQueue queue(pieces, 1);
  for (const uint32_t piece : pieces) {
    const auto order = queue.next(0);
    REQUIRE(order);
    CHECK(order->piece == piece);
    CHECK(order->first == 0);
    CHECK(order->end == 10);
  }
  last_by_cost(pieces, 100, [&](uint32_t piece) { return costs[piece]; });  // fewer than there are processes
  CHECK(pieces.front() == 0);
  CHECK(pieces.back() == 1);
}

TEST_CASE("A grid without pieces to make has no work", "[parts]") { CHECK_FALSE(PieceQueue({}, 3).next(1)); }

}  // namespace teracell::mesher
