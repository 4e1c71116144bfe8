// What two grids call their materials, and a number for each pair of names that meets in a cell.
#pragma once
#include <mutex>
#include <string>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/grid/metadata.hpp"
#include "store/runs/named_runs.hpp"

namespace teracell::inline store {

// Materials of equal name are the same, whatever their ids.
class MaterialNames {
 public:
  MaterialNames(const Metadata& a, const Metadata& b) : of_a(names_of(a)), of_b(names_of(b)) {}
  const std::string& operator[](MaterialName name) const { return names_[name]; }

 private:
  std::vector<MaterialName> names_of(const Metadata& meta) {
    std::vector<MaterialName> out;
    for (const LabelInfo& label : meta.labels) {
      const auto [known, is_new] = numbers_.try_emplace(meta.materials[label.material].name, static_cast<MaterialName>(names_.size()));
      if (is_new) names_.push_back(known->first);
      out.push_back(known->second);
    }
    return out;
  }
  std::unordered_map<std::string, MaterialName> numbers_;
  std::vector<std::string> names_;

 public:
  const std::vector<MaterialName> of_a, of_b;  // by label
};

// Numbers pairs of different names from 1 on, in the order in which they come: so which number a pair gets depends on timing. Threads
// share it.
class ChangeNumbers {
 public:
  struct Pair {
    MaterialName from, to;
  };
  explicit ChangeNumbers(size_t most) : most_(most) {}
  uint32_t of(MaterialName from, MaterialName to) {
    std::lock_guard lock(mutex_);
    const auto [known, is_new] = numbers_.try_emplace(uint64_t{from} << 32 | to, static_cast<uint32_t>(pairs_.size() + 1));
    if (!is_new) return known->second;
    if (pairs_.size() == most_)
      throw InputError(fmt::format("the grids differ by more than {} pairs of materials, which is all that can be told apart", most_));
    pairs_.push_back({from, to});
    return known->second;
  }
  const std::vector<Pair>& pairs() const { return pairs_; }  // pair i has number i + 1. REQUIRES: no thread adds any

 private:
  const size_t most_;
  std::mutex mutex_;
  std::unordered_map<uint64_t, uint32_t> numbers_;
  std::vector<Pair> pairs_;
};

// The same for one thread, which asks the others only for pairs that it has not met.
class KnownChanges {
 public:
  explicit KnownChanges(ChangeNumbers& all) : all_(&all) {}
  // 0 for equal names.
  uint32_t of(MaterialName from, MaterialName to) {
    if (from == to) return 0;
    if (from == last_.from && to == last_.to) return last_number_;
    uint32_t& number = known_[uint64_t{from} << 32 | to];
    if (number == 0) number = all_->of(from, to);
    last_ = {from, to};
    return last_number_ = number;
  }

 private:
  ChangeNumbers* all_;
  std::unordered_map<uint64_t, uint32_t> known_;
  ChangeNumbers::Pair last_{0, 0};
  uint32_t last_number_ = 0;
};

}  // namespace teracell::store
