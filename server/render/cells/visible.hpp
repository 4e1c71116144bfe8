// Which labels a picture shows, and what that means for sets of labels.
#pragma once
#include <vector>

#include "store/grid/label.hpp"

namespace teracell::server {

class Visible {
 public:
  // `damage`: whether what can't be read is shown, as a label after the last one. Without it, that is an error.
  explicit Visible(std::vector<bool> labels, bool damage = false) : labels_(std::move(labels)), damage_(damage) {}
  bool operator()(Label label) const { return labels_[label]; }
  // Of a set: 0 where none of its labels is visible, 1 + the label where one is, kSeveral where more are.
  static constexpr uint32_t kSeveral = ~uint32_t{0};
  static constexpr uint32_t kDamaged = kSeveral - 1;  // in place of a set that can't be read
  bool shows_damage() const { return damage_; }
  Label damage() const { return static_cast<Label>(labels_.size()); }
  uint32_t of(const std::vector<Label>& set) const {
    uint32_t out = 0;
    for (const Label label : set)
      if (labels_[label]) out = out == 0 ? label + 1 : kSeveral;
    return out;
  }
  uint32_t of(Label label) const { return labels_[label] ? label + 1 : 0; }

 private:
  std::vector<bool> labels_;
  bool damage_;
};

}  // namespace teracell::server
