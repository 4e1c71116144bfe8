#include "mesher/closing/surface_counts.hpp"

#include <algorithm>
#include <utility>

#include "mesher/engines/predicates.hpp"

namespace teracell::mesher {
namespace {

bool has_no_area(const Facet& f) { return normal_sign(f, 2) == 0 && normal_sign(f, 1) == 0 && normal_sign(f, 0) == 0; }

}  // namespace

uint32_t VertexNumbers::operator()(const VertexHash& hash) {
  const Recent& recent = recent_[hash.low >> recent_shift_];
  if (recent.hash == hash && recent.number != kNone) return recent.number;
  const uint32_t number = find_or_add(hash);  // may resize recent_
  recent_[hash.low >> recent_shift_] = {hash, number};
  return number;
}

uint32_t VertexNumbers::find(const VertexHash& hash) const {
  const size_t mask = table_.size() - 1;
  size_t i = hash.low & mask;
  while (hashes_[table_[i] - 1] != hash) i = (i + 1) & mask;
  return table_[i] - 1;
}

uint32_t VertexNumbers::find_or_add(const VertexHash& hash) {
  if (2 * hashes_.size() >= table_.size()) grow();
  const size_t mask = table_.size() - 1;
  size_t i = hash.low & mask;
  for (; table_[i] != 0; i = (i + 1) & mask)
    if (hashes_[table_[i] - 1] == hash) return table_[i] - 1;
  hashes_.push_back(hash);
  table_[i] = count();
  return count() - 1;
}

void VertexNumbers::grow() { rehash(std::max<size_t>(kSmallTable, 4 * table_.size())); }

void VertexNumbers::rehash(size_t size) {
  if (size >= kLargeTable && recent_.size() < 512) {
    recent_.assign(512, {});
    recent_shift_ = 55;
  }
  table_.assign(size, 0);
  const size_t mask = table_.size() - 1;
  for (uint32_t number = 0; number < count(); ++number) {
    size_t i = hashes_[number].low & mask;
    while (table_[i] != 0) i = (i + 1) & mask;
    table_[i] = number + 1;
  }
}

// A hash is inserted a few calls later, when its place in the table has reached the cache. On a large mesh nearly every look-up
// misses the cache, and waiting for memory took most of the time.
void DistinctCount::add(uint64_t hash) {
  hash |= uint64_t{hash < 2} << 1;  // 0 marks a free place
  if (2 * (count_ + kWaiting) >= table_.size()) grow();
  __builtin_prefetch(&table_[hash >> 1 & (table_.size() - 1)]);
  std::swap(hash, waiting_[turn_++ % kWaiting]);
  if (hash != 0) count_ += insert(hash);
}

uint64_t DistinctCount::count() {
  for (size_t i = 0; i < kWaiting; ++i) {  // in order of arrival: of equal ones the first determines the orientation
    uint64_t& hash = waiting_[(turn_ + i) % kWaiting];
    if (hash != 0) count_ += insert(std::exchange(hash, 0));
  }
  return count_;
}

bool DistinctCount::insert(uint64_t hash) {
  const size_t mask = table_.size() - 1;
  size_t i = hash >> 1 & mask;
  while (table_[i] != 0 && (table_[i] ^ hash) > 1) i = (i + 1) & mask;
  if (table_[i] != 0) {
    otherwise_ += table_[i] != hash;
    return false;
  }
  table_[i] = hash;
  return true;
}

void DistinctCount::grow() { rehash(std::max<size_t>(64, 4 * table_.size())); }

void DistinctCount::rehash(size_t size) {
  decltype(table_) old(size);
  old.swap(table_);
  for (const uint64_t hash : old)
    if (hash != 0) insert(hash);
}

// A closed surface has about half as many vertices as facets.
void SurfaceCounter::expect(uint64_t facets) {
  numbers_.expect(facets / 2);
  distinct_.expect(facets);
}

void SurfaceCounter::add(const Facet& facet, bool at_home) {
  if (added_ - taken_ == kWaiting) take(waiting_[taken_++ % kWaiting]);
  Waiting& last = waiting_[added_++ % kWaiting];
  last = {vertex_hashes(facet), at_home};
  for (const VertexHash& hash : last.vertices) numbers_.prefetch(hash);
  for (const VertexHash& hash : waiting_[(added_ + kWaiting / 2) % kWaiting].vertices) numbers_.prefetch_known(hash);
  if (at_home) degenerate_ += has_no_area(facet);
}

void SurfaceCounter::take_waiting() {
  while (taken_ < added_) take(waiting_[taken_++ % kWaiting]);
}

uint64_t SurfaceCounter::duplicates() {
  take_waiting();
  return facets_ - distinct_.count();
}

uint64_t SurfaceCounter::opposite() {
  take_waiting();
  return (distinct_.count(), distinct_.otherwise());
}

uint64_t SurfaceCounter::shells() {
  take_waiting();
  return vertices_.count();
}

uint32_t SurfaceCounter::shell_of(const VertexHash& vertex) {
  take_waiting();
  return vertices_.of(numbers_(vertex));
}

void SurfaceCounter::take(const Waiting& facet) {
  std::array<uint32_t, 3> v;
  for (int i = 0; i < 3; ++i) {
    v[i] = numbers_(facet.vertices[i]);
    if (v[i] == vertices_.size()) vertices_.add();
  }
  vertices_.join(v[1], v[0], v[2]);
  if (!facet.at_home) return;
  ++facets_;
  const bool odd = (v[0] > v[1]) ^ (v[1] > v[2]) ^ (v[0] > v[2]);  // whether sorting three different vertices reverses the facet
  // In ascending order, so that the order of a facet's vertices does not matter. Without branches, which can't be predicted.
  const uint32_t low = std::min(v[0], v[1]), high = std::max(v[0], v[1]);
  const uint32_t least = std::min(low, v[2]), greatest = std::max(high, v[2]), middle = std::max(low, std::min(high, v[2]));
  const bool turns = odd & (least != middle) & (middle != greatest);
  distinct_.add((fold(fold(least ^ kHashKeys[0], middle ^ kHashKeys[1]) ^ kHashKeys[2], greatest ^ kHashKeys[3]) & ~uint64_t{1}) | turns);
}

}  // namespace teracell::mesher
