// What was found out about the sets of one chunk, each looked up by its id.
#pragma once
#include <utility>
#include <vector>

#include "store/grid/label.hpp"

namespace teracell::inline store {

template <class T>
class SetMemo {
 public:
  // What is known of the set; the first time, what make() returns. The reference holds until another set is added.
  template <class Make>
  T& get(SetId set, Make&& make) {
    if (known_.size() <= kFew) {
      for (auto& [id, value] : known_)
        if (id == set) return value;
    } else if (set < place_.size() && place_[set] != 0) {
      return known_[place_[set] - 1].second;
    }
    T value = make();
    known_.emplace_back(set, std::move(value));
    if (known_.size() > kFew) index();
    return known_.back().second;
  }
  // Of all sets, in the order in which they came.
  std::vector<T> values() const {
    std::vector<T> out;
    for (const auto& [set, value] : known_) out.push_back(value);
    return out;
  }

 private:
  // Nearly all chunks have so few sets that a search through them is the quickest. A hostile chunk may have millions.
  static constexpr size_t kFew = 16;
  void index() {
    for (size_t i = place_.empty() ? 0 : known_.size() - 1; i < known_.size(); ++i) {
      const SetId set = known_[i].first;
      if (place_.size() <= set) place_.resize(size_t{set} + 1);
      place_[set] = static_cast<uint32_t>(i + 1);
    }
  }
  std::vector<std::pair<SetId, T>> known_;
  std::vector<uint32_t> place_;  // by id: the place in known_ + 1, or 0; empty while there are few
};

}  // namespace teracell::store
