// Which cells of level 0 want to be as fine as which level.
#pragma once
#include <memory>

#include "store/channels/link_reader.hpp"
#include "store/refine/bits.hpp"
#include "store/refine/refinement.hpp"
#include "store/refine/window.hpp"

namespace teracell::inline store {

// Threads may share it.
class Wants {
 public:
  // Keeps a reference to the reader. Throws UsageError if patches are wanted of a grid without links.
  Wants(const GridReader& reader, const Refinement& refinement);

  // Those that matter: below the coarsest, ascending.
  const std::vector<int>& levels() const { return levels_; }
  // Sets, in marks[i], the cells of level 1 that hold a cell which wants levels()[i], or, if that is level 0, lie within `pad` cells of level 0 of
  // one. Of interfaces that the window's sides cut nothing is seen.
  void mark(const Window& window, int64_t pad, std::vector<Bits>& marks) const;
  // Whether nothing in a box, by u, v, w, is wanted if all its cells have this label.
  bool nothing(const Box& box, Label label) const;

 private:
  struct Marker;
  void mark_interfaces(const Window& window, const Marker& mark) const;
  void mark_links(const Window& window, const Marker& mark) const;
  void mark_inside(const Window& window, const Marker& mark) const;
  int level_of(Label a, Label b) const { return of_label_.empty() ? kNoLevel : std::min(of_label_[a], of_label_[b]); }

  const GridReader& reader_;
  int interfaces_;
  std::vector<int> levels_, of_label_, inside_;  // the latter two by label; empty: nothing is said
  std::vector<int> of_patches_;
  std::vector<Refinement::Region> boxes_;        // by u, v, w
  std::unique_ptr<LinkReader> links_;
};

}  // namespace teracell::store
