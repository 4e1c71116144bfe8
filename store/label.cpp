#include "store/label.hpp"

#include <algorithm>
#include <iterator>

namespace teracell {

void put_set(Bytes& out, const std::vector<Label>& set) {
  put_varint(out, set.size());
  for (size_t i = 0; i < set.size(); ++i) put_varint(out, i == 0 ? set[0] : set[i] - set[i - 1] - 1);
}

std::vector<Label> take_set(ByteReader& in, uint32_t labels, uint64_t most) {
  std::vector<Label> set(in.varint(1, std::min<uint64_t>(most, in.remaining()), "set size"));
  uint64_t label = 0;
  for (size_t i = 0; i < set.size(); ++i) {
    label += in.varint(0, labels, "label") + (i > 0);
    if (label >= labels) in.fail("label " + std::to_string(label) + " of " + std::to_string(labels));
    set[i] = static_cast<Label>(label);
  }
  return set;
}

size_t SetTable::Hash::operator()(const std::vector<Label>& v) const {
  uint64_t h = v.size();
  for (const Label label : v) h = (h ^ label) * 0x9E3779B97F4A7C15ull, h ^= h >> 29;
  return h;
}

std::vector<Label> SetTable::members(SetId id) const {
  if (id < labels_) return {id};
  return sets_[id - labels_];
}

SetId SetTable::intern(const std::vector<Label>& members) {
  if (members.size() == 1) return members[0];
  const auto [it, fresh] = ids_.try_emplace(members, labels_ + static_cast<SetId>(sets_.size()));
  if (fresh) sets_.push_back(members);
  return it->second;
}

SetId SetTable::unite_slowly(SetId a, SetId b) {
  const std::vector<Label> x = members(a), y = members(b);
  std::vector<Label> both;
  std::set_union(x.begin(), x.end(), y.begin(), y.end(), std::back_inserter(both));
  return intern(both);
}

size_t SetTable::memory() const {
  size_t members = 0;
  for (const auto& set : sets_) members += set.capacity() * sizeof(Label) + 16;
  // Each set counts twice: in the list, and in a node of the map with its id, its hash and a bucket.
  return 2 * members + sets_.capacity() * sizeof(std::vector<Label>) + ids_.size() * (sizeof(std::vector<Label>) + 48);
}

}  // namespace teracell
