// Which labels a picture shows, and what that means for sets of labels.
#pragma once
#include <vector>

#include "store/grid/label.hpp"

namespace teracell::server {

class Visible {
 public:
  explicit Visible(std::vector<bool> labels) : labels_(std::move(labels)) {}
  bool operator()(Label label) const { return labels_[label]; }
  // Of a set: 0 where none of its labels is visible, 1 + the label where one is, kSeveral where more are.
  static constexpr uint32_t kSeveral = ~uint32_t{0};
  uint32_t of(const std::vector<Label>& set) const {
    uint32_t out = 0;
    for (const Label label : set)
      if (labels_[label]) out = out == 0 ? label + 1 : kSeveral;
    return out;
  }
  uint32_t of(Label label) const { return labels_[label] ? label + 1 : 0; }

 private:
  std::vector<bool> labels_;
};

}  // namespace teracell::server
