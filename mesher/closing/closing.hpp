// Closing a body: is its surface closed, which fill rule has each shell, and what closes the rest: stitches, then caps or
// walls. Surface and what is added have no boundary, by the rule of each shell: so the winding number or the parity along
// every ray is whole, wherever the ray passes, and nothing can leak.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesher/closing/caps.hpp"
#include "mesher/engines/engine.hpp"
#include "mesher/closing/shells.hpp"
#include "mesher/closing/stitch.hpp"

namespace teracell {

// The layer of a body's facets under a rule (compose.hpp): its winding number, or its parity.
inline uint32_t layer_of(size_t body, bool parity) { return static_cast<uint32_t>(2 * body + parity); }
// Where facets of a shell disagree with their neighbours on which side is out: edges that run the same way in both.
struct Flip {
  Vec3 at;  // the first vertex of the first of its edges, as the grid sees it
  uint64_t edges;
};

// Shells of a body that one fill rule serves.
struct FillChoice {
  Fill rule;
  std::optional<uint64_t> shells;  // absent: all
  std::string why;                 // in words
};

// The rule of each facet, where not all have the same. Not thread-safe; fast in ascending order.
class FacetRules {
 public:
  FacetRules(std::shared_ptr<const Shells> shells, std::vector<ShellRule> rules) : shells_(std::move(shells)), rules_(std::move(rules)) {}
  // The layer of facet number `facet` of body `body`, with kIgnored.
  uint32_t layer(size_t body, uint64_t facet) const {
    const ShellRule rule = rules_[shells_->of_facet(facet)];
    const bool ignored = rule == ShellRule::kDistinct && shells_->repeats(facet);
    return layer_of(body, rule != ShellRule::kNonzero) | (ignored ? kIgnored : 0);
  }

 private:
  std::shared_ptr<const Shells> shells_;
  std::vector<ShellRule> rules_;  // of each shell
};

struct ClosedBody {
  std::vector<FillChoice> fill;            // nonzero, evenodd, distinct: those that are used; none for a sheet
  std::shared_ptr<const FacetRules> rules; // null when fill[0] serves all facets
  bool was_open = false;                   // before stitching
  std::array<std::vector<Facet>, 2> added; // stitches and caps, in the file's coordinates: to the winding number, to the parity
  std::array<std::vector<Facet>, 2> walls; // of extruded loops, as the grid sees them
  std::vector<Hole> holes;                 // the largest first
  std::vector<Flip> flips;
  double stitch = 0;                       // the length, in the grid's units
  Seams seams;                             // in the grid's units
  bool cut_from_others = false;            // edges of its boundary belong to parts that were left out

  // The layer of all facets when there are no `rules`.
  uint32_t layer(size_t body) const { return layer_of(body, !fill.empty() && fill[0].rule != Fill::kNonzero); }
  // When they have gone where facets are cast from; the rest is for the report.
  void drop_facets() {
    rules.reset();
    added = walls = {};
  }
  bool adds_facets() const { return !added[0].empty() || !added[1].empty() || !walls[0].empty() || !walls[1].empty(); }
};

// What is known of a surface that was read once.
struct Surface {
  FacetPass facets;       // in the file's order
  uint64_t count;
  bool float32;
  bool in_memory;         // a pass is cheap then
  BoundaryProof boundary;
  bool opposites;         // a sample of the facets holds opposite ones
};

// What closing needs to know of the grid.
struct ClosingFrame {
  double shortest_edge;          // of any cell
  std::array<double, 2> beyond;  // below and above all, along the body's axis of extrusion
};

// Throws InputError: open under `strict`, too large for the memory, a stitch length that is too long.
ClosedBody close_body(const SceneBody& body, const Surface& surface, const ClosingFrame& frame, const Budget& budget);

}  // namespace teracell
