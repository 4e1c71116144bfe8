// Closes a body: finds out whether its surface is closed, chooses a fill rule for each shell, and closes what is open by
// stitches, then by caps or walls. Together they have no boundary under the rule of each shell. So the winding number, or
// the parity, returns to zero along every ray, and nothing can leak.
#pragma once
#include <array>
#include <memory>
#include <vector>

#include "mesher/closing/caps.hpp"
#include "mesher/closing/shells.hpp"
#include "mesher/closing/stitch.hpp"
#include "mesher/engines/engine.hpp"
#include "mesher/surface/read_options.hpp"

namespace teracell::mesher {

class KeptTrees;

// The layer of a body's facets (compose.hpp): one for facets that count for the winding number, one for the parity.
inline uint32_t layer_of(size_t body, bool parity) { return static_cast<uint32_t>(2 * body + parity); }
inline uint32_t body_of_layer(uint32_t layer) { return (layer & ~kIgnored) / 2; }
inline bool is_parity_layer(uint32_t layer) { return layer % 2 != 0; }

// The rule of each facet, for bodies whose facets have different rules. Not thread-safe; fast in ascending order.
class FacetRules {
 public:
  FacetRules(std::shared_ptr<const Shells> shells, std::vector<ShellRule> rules) : shells_(std::move(shells)), rules_(std::move(rules)) {}
  // The layer of a facet, with kIgnored if the facet is to be ignored.
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
  std::vector<FillChoice> fill;            // in the order nonzero, evenodd, distinct; empty for a sheet
  std::shared_ptr<const FacetRules> rules; // null when fill[0] is the rule of all facets
  bool was_open = false;                   // before stitching
  std::array<std::vector<Facet>, 2> added; // stitches and caps, in the file's coordinates: for the winding number, for the parity
  std::array<std::vector<Facet>, 2> walls; // of extruded loops, as the grid sees them; the same two
  std::vector<Hole> holes;                 // the largest first
  std::vector<Flip> flips;
  double stitch = 0;                       // the length, in the grid's units
  Seams seams;                             // in the grid's units
  bool cut_from_others = false;            // edges of its boundary belong to parts that were left out

  // The layer of all facets when there are no `rules`.
  uint32_t layer(size_t body) const { return layer_of(body, !fill.empty() && fill[0].rule != Fill::kNonzero); }
  // Called when the facets are where they are cast from. The rest stays for the report.
  void drop_facets() {
    rules.reset();
    added = walls = {};
  }
  bool adds_facets() const { return !added[0].empty() || !added[1].empty() || !walls[0].empty() || !walls[1].empty(); }
};

// What is known about a surface after it was read once.
struct Surface {
  FacetPass facets;       // in the file's order
  uint64_t count;
  bool float32;
  std::string units;      // that the coordinates of a file with a unit of its own are in
  bool in_memory;         // so a pass is cheap
  BoundaryProof boundary;
  bool opposites;         // a sample of the facets holds facets that lie on each other with opposite orientation
  bool look_around;       // if it is an open part of a file, whether other parts go on where it ends; reads the file once more
  KeptTrees* kept;        // that may hold the file; may be null
  std::shared_ptr<const CadOptions> cad = cad_or_usual(nullptr);  // of exact surfaces
};

// What closing needs to know of the grid.
struct ClosingGrid {
  double shortest_edge;          // of all cells
  std::array<double, 2> beyond;  // coordinates below and above everything, along the body's axis of extrusion
};

// Throws InputError when the body is open and must not be (`strict`), when its boundary does not fit into memory, and when the
// stitch length is too long.
ClosedBody close_body(const SceneBody& body, const Surface& surface, const ClosingGrid& grid, const Budget& budget);

}  // namespace teracell::mesher
