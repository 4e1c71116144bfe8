#include "store/base/sequence_table.hpp"

#include <algorithm>
#include <new>
#include <random>

namespace teracell::inline store {
namespace {

// Not the same in every process: nobody can make a file whose sequences all meet in one place of the table.
uint64_t sequence_hash(std::span<const uint32_t> numbers) {
  static const uint64_t seed = std::random_device()() | uint64_t{std::random_device()()} << 32;
  uint64_t h = seed + numbers.size();
  for (const uint32_t n : numbers) {
    const auto product = static_cast<unsigned __int128>(h ^ n) * 0x9E3779B97F4A7C15ull;
    h = static_cast<uint64_t>(product) ^ static_cast<uint64_t>(product >> 64);
  }
  return h;
}

}  // namespace

uint32_t SequenceTable::intern(std::span<const uint32_t> numbers) {
  if (table_.size() < size_t{2} * (size() + 1)) grow();
  const size_t mask = table_.size() - 1;
  size_t i = sequence_hash(numbers) & mask;
  for (; table_[i] != 0; i = (i + 1) & mask)
    if (same((*this)[table_[i] - 1], numbers)) return table_[i] - 1;
  if (numbers.size() > ~0u - numbers_.size()) throw std::bad_alloc();  // begin_ has 32 bits
  table_[i] = size() + 1;
  numbers_.insert(numbers_.end(), numbers.begin(), numbers.end());
  begin_.push_back(static_cast<uint32_t>(numbers_.size()));
  return size() - 1;
}

void SequenceTable::grow() {
  table_.assign(std::max<size_t>(16, 2 * table_.size()), 0);
  const size_t mask = table_.size() - 1;
  for (uint32_t s = 0; s < size(); ++s) {
    size_t i = sequence_hash((*this)[s]) & mask;
    while (table_[i] != 0) i = (i + 1) & mask;
    table_[i] = s + 1;
  }
}

void SequenceTable::clear() {
  begin_.assign(1, 0);
  numbers_.clear();
  table_.assign(16, 0);
}

}  // namespace teracell::store
