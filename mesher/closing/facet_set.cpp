#include "mesher/closing/facet_set.hpp"

#include <algorithm>
#include <bit>
#include <iterator>

namespace teracell::mesher {
namespace {

constexpr int kFirstBit = 1, kFirstBitOfOthers = 33;

bool are_equal(uint64_t a, uint64_t b) { return a >> 1 == b >> 1; }

}  // namespace

void FacetSet::Marks::clear(uint64_t facets, int first_bit) {
  const size_t words = std::bit_ceil(8 * facets + 64) / 64;
  seen_.assign(words, 0), again_.assign(words, 0);
  first_bit_ = first_bit;
}

// (The members are copied first: words that are written might be them, as far as a compiler knows.)
void FacetSet::Marks::add(std::span<const uint64_t> keys) {
  uint64_t *const seen = seen_.data(), *const again = again_.data();
  const size_t mask = seen_.size() - 1;
  const int first_bit = first_bit_;
  for (const uint64_t key : keys) {
    const uint64_t places = key >> first_bit, bit = uint64_t{1} << (places & 63);
    const size_t word = places >> 6 & mask;
    if (const uint64_t before = seen[word]; before & bit) again[word] |= bit;
    else seen[word] = before | bit;
  }
}

void FacetSet::expect(uint64_t facets) {
  if (sample_) return;
  room_ = facets;
  keys_.reserve(facets);
  make_marks();
}

void FacetSet::make_marks() {
  marks_.clear(room_, kFirstBit);
  for (size_t i = 0; i < marked_; ++i) marks_.add(keys_[i]);
}

void FacetSet::add(std::span<const uint64_t> keys) {
  if (sample_) {
    for (const uint64_t key : keys) add(key);
    return;
  }
  while (keys_.size() + keys.size() > room_) make_room();
  const size_t before = keys_.size();
  keys_.insert(keys_.end(), keys.begin(), keys.end());
  for (const uint64_t key : keys) marks_.prefetch(key);
  marks_.add(std::span(keys_).subspan(marked_, before - marked_));
  marked_ = before;
}

void FacetSet::make_room() {
  if (sample_) {
    thin_out();
    room_ = kRoomOfSample;
  } else {
    room_ = std::max(kLeastRoom, grown(room_));
    keys_.reserve(room_);
    make_marks();
  }
}

void FacetSet::keep_sample() {
  sample_ = true;
  make_room();
  keys_.shrink_to_fit();
  marks_ = Marks();
}

void FacetSet::add(const FacetSet& other) {
  most_ = std::min(most_, other.most_);
  least_opposite_ = std::min(least_opposite_, other.least_opposite_);
  std::erase_if(keys_, [&](uint64_t key) { return key > most_; });
  for (const uint64_t key : other.keys_) add(key);
}

// Drops what is beyond the sample, and all but one of facets that are equal.
void FacetSet::thin_out() {
  const Found found = find_equal();
  most_ = found.end_of_sample;
  least_opposite_ = found.least_opposite;
  std::erase_if(keys_, [&](uint64_t key) { return key > most_; });
  if (found.duplicates == 0) return;
  std::ranges::sort(keys_);
  keys_.erase(std::unique(keys_.begin(), keys_.end(), are_equal), keys_.end());
}

void FacetSet::clear() {
  keys_.clear();
  if (keys_.capacity() > kRoomOfSample) keys_ = decltype(keys_)(), marks_ = Marks();  // = {} would keep the memory
  room_ = sample_ ? kRoomOfSample : 0;
  marked_ = 0;
  most_ = least_opposite_ = ~uint64_t{0};
}

// All facets that are equal to another one, and hardly any others, in order of arrival.
std::vector<uint64_t> FacetSet::perhaps_equal() {
  if (sample_) marks_.clear(keys_.size(), kFirstBit), marked_ = 0;
  while (marked_ < keys_.size()) marks_.add(keys_[marked_++]);
  std::vector<uint64_t> out;
  std::ranges::copy_if(keys_, std::back_inserter(out), [&](uint64_t key) { return marks_.is_marked_again(key); });
  Marks others;
  others.clear(out.size(), kFirstBitOfOthers);
  for (const uint64_t key : out) others.add(key);
  std::erase_if(out, [&](uint64_t key) { return !others.is_marked_again(key); });
  return out;
}

FacetSet::Found FacetSet::find_equal() {
  Found out{.end_of_sample = most_, .least_opposite = least_opposite_};
  std::vector<uint64_t> found = perhaps_equal();
  std::ranges::stable_sort(found, {}, [](uint64_t key) { return key >> 1; });
  std::array<uint64_t, 65> of_bits{};  // how many different keys have so many bits
  const auto bits = [](uint64_t key) { return static_cast<size_t>(std::bit_width(key)); };
  for (size_t first = 0, i = 1; i < found.size(); ++i) {
    if (!are_equal(found[first], found[i])) {
      first = i;
      continue;
    }
    ++out.duplicates;
    --of_bits[bits(found[i])];
    if (found[i] == found[first]) continue;
    ++out.opposite;
    out.least_opposite = std::min(out.least_opposite, found[i] & ~uint64_t{1});
  }
  if (!sample_ && out.least_opposite == ~uint64_t{0}) return out;  // nobody asks where a sample would end
  for (const uint64_t key : keys_) ++of_bits[bits(key)];
  for (uint64_t count = keys_.size() - out.duplicates; count > kMost; out.end_of_sample /= 2) count -= of_bits[bits(out.end_of_sample)];
  return out;
}

EqualFacets FacetSet::equal() {
  const Found found = find_equal();
  return {found.duplicates, found.opposite, found.least_opposite != ~uint64_t{0} && found.least_opposite <= found.end_of_sample};
}

}  // namespace teracell::mesher
