#include "store/grid/label.hpp"

#include <algorithm>
#include <iterator>

namespace teracell::inline store {

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

std::vector<Label> SetTable::members(SetId id) const {
  if (id < labels_) return {id};
  const std::span<const Label> set = sets_[id - labels_];
  return {set.begin(), set.end()};
}

SetId SetTable::intern(const std::vector<Label>& members) {
  if (members.size() == 1) return members[0];
  return labels_ + sets_.intern(members);
}

SetId SetTable::unite_slowly(SetId a, SetId b) {
  const auto labels_of = [&](const SetId& id) { return id < labels_ ? std::span<const Label>(&id, 1) : sets_[id - labels_]; };
  const std::span<const Label> x = labels_of(a), y = labels_of(b);
  std::vector<Label> both;
  both.reserve(x.size() + y.size());
  std::ranges::set_union(x, y, std::back_inserter(both));
  return intern(both);
}

}  // namespace teracell::store
