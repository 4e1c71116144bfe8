// The chunks of level 2 in the order of the tree (pyramid.hpp), in which a file's chunks are put.
#pragma once
#include <optional>
#include <utility>
#include <vector>

#include "store/runs/pyramid.hpp"

namespace teracell::inline store {

class TreeOrder {
 public:
  // Of chunks_u x chunks_v chunks.
  TreeOrder(uint32_t chunks_u, uint32_t chunks_v) : chunks_u_(chunks_u), chunks_v_(chunks_v) {
    int height = 0;
    while (uint64_t{1} << (kFanOutBits * height) < std::max(chunks_u, chunks_v)) ++height;
    waiting_.push_back({height, 0, 0});
  }
  // The next (cu, cv); none at the end.
  std::optional<std::pair<uint32_t, uint32_t>> next() {
    while (!waiting_.empty()) {
      const Node node = waiting_.back();
      waiting_.pop_back();
      const int shift = kFanOutBits * node.height;
      if (node.cu << shift >= chunks_u_ || node.cv << shift >= chunks_v_) continue;
      if (node.height == 0) return std::pair(static_cast<uint32_t>(node.cu), static_cast<uint32_t>(node.cv));
      for (uint32_t i = kChildren; i-- > 0;) waiting_.push_back({node.height - 1, node.cu * kFanOut + i % kFanOut, node.cv * kFanOut + i / kFanOut});
    }
    return std::nullopt;
  }

 private:
  struct Node {
    int height;
    uint64_t cu, cv;
  };
  const uint32_t chunks_u_, chunks_v_;
  std::vector<Node> waiting_;  // the last one comes first
};

}  // namespace teracell::store
