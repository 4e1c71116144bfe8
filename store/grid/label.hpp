// Labels and sets of labels.
//
// A *label* is what a cell of level 0 carries: a material, or, if the scene keeps bodies apart, a material and a body. A
// coarse cell carries the *set* of the labels below it. Runs name sets by small ids from a SetTable. Ids below the number
// of labels are the sets of one label, so level 0 needs no table. Larger sets get ids as they occur. An id means nothing
// outside its table. In the file each chunk lists the members of its sets, so chunks depend on nothing else.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "store/base/bytes.hpp"
#include "store/base/sequence_table.hpp"

namespace teracell::inline store {

using Label = uint32_t;
using SetId = uint32_t;

// A set, labels ascending, as bytes (FORMAT.md, "Index page").
void put_set(Bytes& out, const std::vector<Label>& set);
// Throws FormatError unless there are at most `most` labels, all below `labels`.
std::vector<Label> take_set(ByteReader& in, uint32_t labels, uint64_t most);

// Not thread-safe: each worker or chunk has its own.
class SetTable {
 public:
  explicit SetTable(uint32_t labels) : labels_(labels) { clear_memo(); }

  uint32_t labels() const { return labels_; }
  uint32_t ids() const { return labels_ + sets_.size(); }  // handed out so far, including sets of one label
  // Members in ascending order.
  std::vector<Label> members(SetId id) const;
  // REQUIRES: members ascend strictly and are below labels(). None stand for what can't be read; such a set is not to be united.
  SetId intern(const std::vector<Label>& members);
  size_t memory() const { return sets_.memory(); }  // bytes on the heap
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
  void clear_memo() { memo_.fill({~0u, ~0u, 0}); }
  SetId unite_slowly(SetId a, SetId b);

  uint32_t labels_;
  SequenceTable sets_;  // sets_[i] has id labels_ + i
  std::array<Memo, 64> memo_;
};

}  // namespace teracell::store
