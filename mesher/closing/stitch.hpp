// Stitching joins open edges that lie within the stitch length of each other. Caps then close what is still open. Patches that
// were meshed separately have different vertices along their seam, or vertices that differ in the last digits. If each patch
// were capped on its own, the caps would cut away the solid between them.
//
// No vertex is moved. A few facets are added between each open edge and its place on the seam, where the edges of both sides
// cancel. So the surface with its stitches has a shorter boundary, and with its caps none. The work is proportional to the
// length of the boundary, not to the size of the surface.
#pragma once
#include <array>
#include <vector>

#include "mesher/closing/boundary.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell::mesher {

using ShellRule = Fill;

struct OpenEdge {
  BoundaryEdge edge;
  uint32_t shell;
};

// The shells that stitching has joined count as one: a group.
struct Stitched {
  std::vector<ShellRule> rule;               // of each shell; none is kAuto
  std::array<std::vector<Facet>, 2> facets;  // the stitches of shells that add up windings, and of shells that count crossings
  struct Group {
    bool by_parity;                   // its shells count crossings
    std::vector<BoundaryEdge> left;   // its boundary under that rule after stitching
  };
  std::vector<Group> groups;
  std::vector<BoundaryEdge> flips;           // still open by winding number but closed by parity, under either rule
  Seams seams;  // in the file's units
};

// `edges` are the open edges, `rules` the rules of all shells. REQUIRES: edges of a shell that counts crossings are odd().
// `stitch` is the stitch length in the file's units; with 0 only groups and rules are found. Distances are compared in doubles
// (README.md). Throws InputError, which begins with `name`, when more than 64 facets per open edge would be needed.
Stitched stitch_boundary(const std::vector<OpenEdge>& edges, std::vector<ShellRule> rules, double stitch, const std::string& name);

}  // namespace teracell::mesher
