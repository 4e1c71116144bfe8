// Which cells of a mesh hang together through faces.
#pragma once
#include "tools/export/refined/leaf_block.hpp"

namespace teracell::exports {

// Sets that are joined (R. Tarjan 1975). The first of its members stands for a set.
class JoinedSets {
 public:
  uint32_t add() {
    above_.push_back(static_cast<uint32_t>(above_.size()));
    return above_.back();
  }
  uint32_t root(uint32_t i) {
    while (above_[i] != i) i = above_[i] = above_[above_[i]];
    return i;
  }
  void join(uint32_t a, uint32_t b) {
    a = root(a), b = root(b);
    above_[std::max(a, b)] = std::min(a, b);
  }
  uint32_t size() const { return static_cast<uint32_t>(above_.size()); }

 private:
  std::vector<uint32_t> above_;
};

// Fills LeafBlock::region: what hangs together within the block.
void find_regions(LeafBlock& block, const Box& box);

}  // namespace teracell::exports
