// Labels and sets of labels.
//
// A *label* is what a level-0 cell carries: a material, or with "label_by": "body" a (material, body) pair. A coarse
// cell carries the *set* of the labels below it. Runs name sets by small ids that a SetTable hands out: ids below the
// number of labels are the one-member sets, so level 0 needs no table at all; larger sets get ids as they turn up.
// Ids mean nothing outside their table. In the file a chunk spells its sets out, so chunks depend on nothing.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "store/bytes.hpp"

namespace teracell {

using Label = uint32_t;
using SetId = uint32_t;

// A set, labels ascending, as bytes (FORMAT.md, "Index page").
void put_set(Bytes& out, const std::vector<Label>& set);
// Throws FormatError unless there are at most `most` labels, all below `labels`.
std::vector<Label> take_set(ByteReader& in, uint32_t labels, uint64_t most);

// Not thread-safe: one table per worker or per chunk.
class SetTable {
 public:
  explicit SetTable(uint32_t labels) : labels_(labels) { clear_memo(); }

  uint32_t labels() const { return labels_; }
  uint32_t ids() const { return labels_ + static_cast<uint32_t>(sets_.size()); }  // handed out so far, one-member sets included
  // Members in ascending order.
  std::vector<Label> members(SetId id) const;
  // REQUIRES: members ascend strictly, are below labels(), at least one.
  SetId intern(const std::vector<Label>& members);
  size_t memory() const;  // bytes on the heap, about
  SetId unite(SetId a, SetId b) {
    if (a == b) return a;
    if (a > b) std::swap(a, b);
    Memo& m = memo_[(a * 31 + b) % memo_.size()];
    if (m.a != a || m.b != b) m = {a, b, unite_slowly(a, b)};
    return m.result;
  }

 private:
  struct Memo {
    SetId a, b, result;
  };
  struct Hash {
    size_t operator()(const std::vector<Label>& v) const;
  };
  void clear_memo() { memo_.fill({~0u, ~0u, 0}); }
  SetId unite_slowly(SetId a, SetId b);

  uint32_t labels_;
  std::vector<std::vector<Label>> sets_;  // sets_[i] has id labels_ + i
  std::unordered_map<std::vector<Label>, SetId, Hash> ids_;
  std::array<Memo, 64> memo_;
};

}  // namespace teracell
