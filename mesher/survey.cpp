#include "mesher/survey.hpp"

#include <algorithm>

#include <xxhash.h>

#include "mesher/predicates.hpp"

namespace teracell {
namespace {

// Numbers for hashes, in the order of first appearance: open addressing, no erasure.
class Numbering {
 public:
  explicit Numbering(size_t expected) {
    size_t slots = 16;
    while (slots < 2 * expected) slots *= 2;
    slots_.resize(slots);
  }
  uint32_t operator()(uint64_t hash) {
    size_t i = hash & (slots_.size() - 1);
    while (slots_[i].number != 0 && slots_[i].hash != hash) i = (i + 1) & (slots_.size() - 1);
    if (slots_[i].number == 0) slots_[i] = {hash, ++count_};
    return slots_[i].number - 1;
  }
  uint32_t count() const { return count_; }

 private:
  struct Slot {
    uint64_t hash = 0;
    uint32_t number = 0;  // 1 more than what it stands for; 0 is free
  };
  std::vector<Slot> slots_;
  uint32_t count_ = 0;
};

bool has_no_area(const Facet& f) {
  return normal_sign(f, 2) == 0 && normal_sign(f, 1) == 0 && normal_sign(f, 0) == 0;
}

}  // namespace

Survey survey(std::span<const SceneFacet> facets) {
  Survey out;
  Numbering numbering(3 * facets.size());  // a soup has three vertices a facet
  std::vector<uint32_t> parent;            // union-find over vertices
  const auto root = [&](uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  std::vector<uint64_t> keys;  // of facets, whatever the order of their vertices
  keys.reserve(facets.size());
  for (const SceneFacet& f : facets) {
    out.degenerate += has_no_area(f.facet);
    std::array<uint32_t, 3> v;
    for (int i = 0; i < 3; ++i) {
      v[i] = numbering(XXH3_64bits(f.facet.vertex[i].data(), sizeof(Vec3)));
      if (v[i] == parent.size()) parent.push_back(v[i]);
    }
    for (int i = 1; i < 3; ++i) parent[root(v[i])] = root(v[0]);
    std::ranges::sort(v);
    keys.push_back(XXH3_64bits(v.data(), sizeof v));
  }
  for (uint32_t v = 0; v < parent.size(); ++v) out.shells += parent[v] == v;
  std::ranges::sort(keys);
  for (size_t i = 1; i < keys.size(); ++i) out.duplicates += keys[i] == keys[i - 1];
  return out;
}

}  // namespace teracell
