#include "store/label.hpp"

#include <algorithm>
#include <iterator>

namespace teracell {

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

}  // namespace teracell
