#include "mesher/survey.hpp"

#include <algorithm>

#include <xxhash.h>

#include "mesher/predicates.hpp"

namespace teracell {
namespace {

// Numbers for hashes, in the order of first appearance: open addressing, no erasure. It grows with what it holds: a
// table for the worst case would be cold memory for the usual one.
class Numbering {
 public:
  uint32_t operator()(uint64_t hash) {
    if (2 * count_ >= slots_.size()) grow();
    Slot& slot = find(hash);
    if (slot.number == 0) slot = {hash, ++count_};
    return slot.number - 1;
  }
  uint32_t count() const { return count_; }

 private:
  struct Slot {
    uint64_t hash = 0;
    uint32_t number = 0;  // 1 more than what it stands for; 0 is free
  };
  Slot& find(uint64_t hash) {
    size_t i = hash & (slots_.size() - 1);
    while (slots_[i].number != 0 && slots_[i].hash != hash) i = (i + 1) & (slots_.size() - 1);
    return slots_[i];
  }
  void grow() {
    std::vector<Slot> old(std::max<size_t>(1024, 4 * slots_.size()));
    old.swap(slots_);
    for (const Slot& s : old)
      if (s.number != 0) find(s.hash) = s;
  }
  std::vector<Slot> slots_;
  uint32_t count_ = 0;
};

bool has_no_area(const Facet& f) {
  return normal_sign(f, 2) == 0 && normal_sign(f, 1) == 0 && normal_sign(f, 0) == 0;
}

}  // namespace

Survey survey(std::span<const SceneFacet> facets) {
  Survey out;
  Numbering vertices, distinct;
  std::vector<uint32_t> parent;  // union-find over vertices
  const auto root = [&](uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const SceneFacet& f : facets) {
    out.degenerate += has_no_area(f.facet);
    std::array<uint32_t, 3> v;
    for (int i = 0; i < 3; ++i) {
      v[i] = vertices(XXH3_64bits(f.facet.vertex[i].data(), sizeof(Vec3)));
      if (v[i] == parent.size()) parent.push_back(v[i]);
    }
    for (int i = 1; i < 3; ++i) parent[root(v[i])] = root(v[0]);
    std::ranges::sort(v);  // the same facet, whatever the order of its vertices
    distinct(XXH3_64bits(v.data(), sizeof v));
  }
  out.duplicates = facets.size() - distinct.count();
  for (uint32_t v = 0; v < parent.size(); ++v) out.shells += parent[v] == v;
  return out;
}

}  // namespace teracell
