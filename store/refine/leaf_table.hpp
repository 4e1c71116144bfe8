// How many leaves a refined grid has, for people and programs.
#pragma once
#include "store/refine/leaves.hpp"

namespace teracell::inline store {

class LeafTable {
 public:
  LeafTable(const Metadata& meta, const Refinement& refinement, const LeafCounts& counts);

  uint64_t total() const { return total_; }
  // A row for each level, below the names of the materials, and a last one with sums.
  std::vector<std::string> rows() const;
  // {"schema": 1, "coarsest", "layers", "total", "leaves": [{"level", "material", "leaves"}]}
  std::string json() const;

 private:
  const Metadata& meta_;
  const int coarsest_, layers_;
  std::map<std::pair<int, uint32_t>, uint64_t> by_material_;  // by level and material
  uint64_t total_ = 0;
};

}  // namespace teracell::store
