#include "mesher/survey.hpp"

#include <algorithm>
#include <utility>

#include <xxhash.h>

#include "mesher/predicates.hpp"

namespace teracell {
namespace {

// Numbers for hashes, in the order of first appearance: open addressing, no erasure. It grows with what it holds: a
// table for the worst case would be cold memory for the usual one.
class Numbering {
 public:
  uint32_t operator()(uint64_t hash) {
    if (2 * hashes_.size() >= slots_.size()) grow();
    const size_t mask = slots_.size() - 1;
    size_t i = hash & mask;
    for (; slots_[i] != 0; i = (i + 1) & mask)
      if (hashes_[slots_[i] - 1] == hash) return slots_[i] - 1;
    hashes_.push_back(hash);
    slots_[i] = count();
    return count() - 1;
  }
  uint32_t count() const { return static_cast<uint32_t>(hashes_.size()); }

 private:
  void grow() {
    slots_.assign(std::max<size_t>(1024, 4 * slots_.size()), 0);
    const size_t mask = slots_.size() - 1;
    for (uint32_t number = 0; number < count(); ++number) {
      size_t i = hashes_[number] & mask;
      while (slots_[i] != 0) i = (i + 1) & mask;
      slots_[i] = number + 1;
    }
  }
  std::vector<uint64_t> hashes_;  // by number
  std::vector<uint32_t> slots_;   // number + 1; 0 is free
};

// Counts distinct hashes. They wait a moment for their place to reach the cache: on a large mesh nearly every look-up
// misses it, and waiting for memory was most of the survey.
class DistinctCount {
 public:
  void add(uint64_t hash) {
    hash |= hash == 0;  // 0 is free
    if (2 * (count_ + kWaiting) >= slots_.size()) grow();
    __builtin_prefetch(&slots_[hash & (slots_.size() - 1)]);
    std::swap(hash, waiting_[turn_++ % kWaiting]);
    if (hash != 0) count_ += insert(hash);
  }
  uint64_t finish() {
    for (uint64_t& hash : waiting_)
      if (hash != 0) count_ += insert(std::exchange(hash, 0));
    return count_;
  }

 private:
  static constexpr size_t kWaiting = 16;
  bool insert(uint64_t hash) {
    const size_t mask = slots_.size() - 1;
    size_t i = hash & mask;
    while (slots_[i] != 0 && slots_[i] != hash) i = (i + 1) & mask;
    return std::exchange(slots_[i], hash) == 0;
  }
  void grow() {
    std::vector<uint64_t> old(std::max<size_t>(1024, 4 * slots_.size()));
    old.swap(slots_);
    for (const uint64_t hash : old)
      if (hash != 0) insert(hash);
  }
  std::vector<uint64_t> slots_;
  std::array<uint64_t, kWaiting> waiting_{};
  uint64_t count_ = 0, turn_ = 0;
};

// Gives vertices numbers. Neighbouring facets come one after another and share vertices: a small cache in front spares
// two of three look-ups.
class VertexNumbers {
 public:
  uint32_t operator()(const Vec3& v) {
    const uint64_t hash = XXH3_64bits(v.data(), sizeof v);
    Recent& recent = recent_[hash >> 53];
    if (recent.hash != hash || recent.number == kNone) recent = {hash, numbers_(hash)};
    return recent.number;
  }

 private:
  static constexpr uint32_t kNone = ~uint32_t{0};
  struct Recent {
    uint64_t hash = 0;
    uint32_t number = kNone;
  };
  std::array<Recent, 2048> recent_;
  Numbering numbers_;
};

bool has_no_area(const Facet& f) {
  return normal_sign(f, 2) == 0 && normal_sign(f, 1) == 0 && normal_sign(f, 0) == 0;
}

}  // namespace

Survey survey(const FacetStore& facets, uint64_t first, uint64_t last, const std::atomic<bool>& stop) {
  Survey out;
  VertexNumbers numbers;
  DistinctCount distinct;
  std::vector<uint32_t> parent;  // union-find over vertices
  const auto root = [&](uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  facets.for_each(first, last, [&](const SceneFacet& f) {
    if (stop) return;
    out.degenerate += has_no_area(f.facet);
    std::array<uint32_t, 3> v;
    for (int i = 0; i < 3; ++i) {
      v[i] = numbers(f.facet.vertex[i]);
      if (v[i] == parent.size()) parent.push_back(v[i]);
    }
    for (int i = 1; i < 3; ++i) parent[root(v[i])] = root(v[0]);
    std::ranges::sort(v);  // the same facet, whatever the order of its vertices
    distinct.add(XXH3_64bits(v.data(), sizeof v));
  });
  out.duplicates = last - first - distinct.finish();
  for (uint32_t v = 0; v < parent.size(); ++v) out.shells += parent[v] == v;
  return out;
}

}  // namespace teracell
