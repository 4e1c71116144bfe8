#include "mesher/closing/facet_set.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <utility>

namespace teracell::mesher {

void FacetSet::expect(uint64_t facets) {
  if (!sample_) rehash(std::bit_ceil(2 * (facets + kWaiting)));
}

void FacetSet::insert(uint64_t key) {
  if (key > most_) return;
  size_t i = place_of(key);
  while (table_[i] != 0 && (table_[i] ^ key) > 1) i = (i + 1) & (table_.size() - 1);
  if (table_[i] == 0) {
    table_[i] = key;
    ++count_;
  } else if (table_[i] != key) {
    ++opposite_;
    least_opposite_ = std::min(least_opposite_, key & ~uint64_t{1});
  }
}

// In order of arrival: of equal ones the first determines the orientation.
void FacetSet::take_waiting() {
  for (size_t i = 0; i < kWaiting; ++i)
    if (uint64_t& key = waiting_[(turn_ + i) % kWaiting]; key != 0) insert(std::exchange(key, 0));
}

void FacetSet::grow() {
  if (sample_) drop_beyond_sample();
  if (2 * (count_ + kWaiting) > table_.size()) rehash(std::max(kLeastTable, grown(table_.size())));
}

void FacetSet::rehash(size_t size) {
  decltype(table_) old(size);
  old.swap(table_);
  count_ = 0;
  for (const uint64_t key : old) {
    if (key == 0 || key > most_) continue;
    ++count_;
    size_t i = place_of(key);
    while (table_[i] != 0) i = (i + 1) & (table_.size() - 1);
    table_[i] = key;
  }
}

// The greatest key that a sample of what is in the table may hold.
uint64_t FacetSet::end_of_sample() const {
  if (count_ <= kMost) return most_;
  std::array<uint64_t, 65> keys{};  // by their number of bits
  for (const uint64_t key : table_) ++keys[static_cast<size_t>(std::bit_width(key))];
  uint64_t most = most_;
  for (uint64_t count = count_; count > kMost; most /= 2) count -= keys[static_cast<size_t>(std::bit_width(most))];
  return most;
}

void FacetSet::drop_beyond_sample() {
  const uint64_t most = end_of_sample();
  if (most == most_) return;
  most_ = most;
  rehash(2 * (kMost + kWaiting));
}

void FacetSet::keep_sample() {
  sample_ = true;
  take_waiting();
  drop_beyond_sample();
}

void FacetSet::clear() {
  const bool sample = sample_;
  auto table = std::exchange(table_, {});
  *this = FacetSet();
  sample_ = sample;
  if (table.empty() || table.size() > 2 * (kMost + kWaiting)) return;
  table_ = std::move(table);
  table_.assign(kLeastTable, 0);
}

uint64_t FacetSet::duplicates() {
  take_waiting();
  return added_ - count_;
}

uint64_t FacetSet::opposite() {
  take_waiting();
  return opposite_;
}

bool FacetSet::sample_has_opposites() {
  take_waiting();
  return least_opposite_ != ~uint64_t{0} && least_opposite_ <= end_of_sample();
}

}  // namespace teracell::mesher
