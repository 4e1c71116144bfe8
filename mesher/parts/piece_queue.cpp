#include "mesher/parts/piece_queue.hpp"

#include <algorithm>

namespace teracell::mesher {

PieceQueue::PieceQueue(std::vector<uint32_t> pieces, uint32_t homes) : pieces_(std::move(pieces)), left_(pieces_.size()) {
  for (size_t i = 0; i < homes; ++i) homes_.push_back(between(pieces_.size() * i / homes, pieces_.size() * (i + 1) / homes));
}

PieceQueue::Home PieceQueue::between(size_t from, size_t to) const {
  if (from == to) return {from, to, 0, 0};
  const auto [first, last] =
      std::ranges::minmax_element(pieces_.begin() + static_cast<ptrdiff_t>(from), pieces_.begin() + static_cast<ptrdiff_t>(to));
  return {from, to, *first, *last};
}

std::optional<PieceQueue::Order> PieceQueue::next(uint32_t home) {
  Home& own = homes_[home];
  if (own.at == own.end) {
    Home& other = *std::ranges::max_element(homes_, {}, [](const Home& h) { return h.end - h.at; });
    if (other.at == other.end) return std::nullopt;
    const size_t middle = other.at + (other.end - other.at) / 2;
    own = between(middle, other.end);
    other.end = middle;
  }
  --left_;
  return Order{pieces_[own.at++], own.first, own.last + 1};
}

void last_by_cost(std::vector<uint32_t>& pieces, size_t processes, const std::function<uint64_t(uint32_t piece)>& cost) {
  std::ranges::stable_sort(pieces.end() - static_cast<ptrdiff_t>(std::min(processes, pieces.size())), pieces.end(), std::greater(), cost);
}

}  // namespace teracell::mesher
