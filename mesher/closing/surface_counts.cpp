#include "mesher/closing/surface_counts.hpp"

#include <algorithm>
#include <utility>

#include "mesher/engines/predicates.hpp"

namespace teracell::mesher {

uint32_t VertexNumbers::look_up(const VertexHash& hash) {
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

void VertexNumbers::grow() { rehash(std::max<size_t>(kSmallTable, (table_.size() < kFastGrowth ? 4 : 2) * table_.size())); }

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

void ShellCounter::add(const std::array<VertexHash, 3>& facet) {
  if (added_ - taken_ == kWaiting) take(waiting_[taken_++ % kWaiting]);
  waiting_[added_++ % kWaiting] = facet;
  for (const VertexHash& hash : facet) numbers_.prefetch(hash);
  for (const VertexHash& hash : waiting_[(added_ + kWaiting / 2) % kWaiting]) numbers_.prefetch_known(hash);
}

void ShellCounter::add(const Facet& facet, const std::array<uint32_t, 3>& numbers) {
  ++numbered_;
  const uint64_t most = uint64_t{8} * numbered_ + 65536;  // of a file with many vertices, few may be of its facets
  if (std::max({numbers[0], numbers[1], numbers[2]}) >= most) return add(vertex_hashes(facet));
  std::array<uint32_t, 3> v;
  for (int i = 0; i < 3; ++i) {
    if (numbers[i] >= known_.size()) known_.resize(std::max<size_t>(numbers[i] + size_t{1}, 2 * known_.size()));
    uint32_t& known = known_[numbers[i]];
    if (known == 0) known = number_of(vertex_hash(facet.vertex[i])) + 1;
    v[i] = known - 1;
  }
  vertices_.join(v[1], v[0], v[2]);
}

void ShellCounter::take(const std::array<VertexHash, 3>& facet) {
  std::array<uint32_t, 3> v;
  for (int i = 0; i < 3; ++i) v[i] = number_of(facet[i]);
  vertices_.join(v[1], v[0], v[2]);
}

void ShellCounter::take_waiting() {
  while (taken_ < added_) take(waiting_[taken_++ % kWaiting]);
}

uint64_t ShellCounter::shells() {
  take_waiting();
  return vertices_.count();
}

uint32_t ShellCounter::shell_of(const VertexHash& vertex) {
  take_waiting();
  return vertices_.of(numbers_(vertex));
}

bool has_no_area(const Facet& f) { return normal_sign(f, 2) == 0 && normal_sign(f, 1) == 0 && normal_sign(f, 0) == 0; }

}  // namespace teracell::mesher
