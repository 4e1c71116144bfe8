#include "mesher/closing/surface_counts.hpp"

#include <algorithm>

#include "mesher/surface/read_options.hpp"

namespace teracell::mesher {

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

void VertexNumbers::find_or_add(std::span<const VertexHash> hashes, uint32_t* numbers) {
  for (const VertexHash& hash : hashes) prefetch(hash);
  for (const VertexHash& hash : hashes) prefetch_known(hash);
  for (const VertexHash& hash : hashes) *numbers++ = find_or_add(hash);
}

void VertexNumbers::grow() { rehash(std::max(kLeastTable, grown(table_.size()))); }

void VertexNumbers::rehash(size_t size) {
  table_.assign(size, 0);
  const size_t mask = table_.size() - 1;
  for (uint32_t number = 0; number < count(); ++number) {
    size_t i = hashes_[number].low & mask;
    while (table_[i] != 0) i = (i + 1) & mask;
    table_[i] = number + 1;
  }
}

void ShellCounter::add(const Facet& facet, const std::array<uint32_t, 3>& numbers) {
  ++numbered_;
  // Of a file with many vertices, few may be of its facets.
  const uint64_t most = std::min(2 * numbered_ + 65536, uint64_t{kNoVertexNumber});
  if (std::max({numbers[0], numbers[1], numbers[2]}) >= most) return add(vertex_hashes(facet));
  std::array<uint32_t, 3> v;
  for (int i = 0; i < 3; ++i) {
    if (numbers[i] >= known_.size()) known_.resize(std::max<size_t>(numbers[i] + size_t{1}, 2 * known_.size()));
    uint32_t& known = known_[numbers[i]];
    if (known == 0) {
      const VertexHash hash = vertex_hash(facet.vertex[i]);
      known = first_seen(hash.low, hash.high) + 1;
    }
    v[i] = known - 1;
  }
  nodes_.join(v[1], v[0], v[2]);
}

uint32_t ShellCounter::first_seen(uint64_t low, uint64_t high) {
  if (waited_ - settled_ == kWaiting) settle(waiting_[settled_++ % kWaiting]);
  Waiting& waiting = waiting_[waited_++ % kWaiting];
  waiting = {{low, high}, nodes_.add()};
  numbers_.prefetch(waiting.vertex);
  numbers_.prefetch_known(waiting_[(waited_ + kWaiting / 2) % kWaiting].vertex);
  return nodes_.size() - 1;
}

void ShellCounter::settle(const Waiting& waiting) {
  const uint32_t number = numbers_.find_or_add(waiting.vertex);
  if (number == first_node_.size()) first_node_.push_back(waiting.node);
  else nodes_.join(first_node_[number], waiting.node);
}

void ShellCounter::settle_all() {
  while (settled_ < waited_) settle(waiting_[settled_++ % kWaiting]);
}

uint64_t ShellCounter::shells() {
  settle_all();
  return nodes_.count();
}

uint32_t ShellCounter::shell_of(const VertexHash& vertex) {
  settle_all();
  return nodes_.of(first_node_[numbers_.find(vertex)]);
}

void SurfaceCounter::add(const Facet& facet) {
  const std::array<VertexHash, 3> hashes = vertex_hashes(facet);
  std::array<uint32_t, 3> numbers;
  number(hashes, numbers.data());
  join(numbers);
  const uint64_t key = FacetSet::key_of({hashes[0].low, hashes[1].low, hashes[2].low});
  count({&key, 1}, has_no_area(facet));
}

}  // namespace teracell::mesher
