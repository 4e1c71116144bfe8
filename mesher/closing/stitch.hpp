// Stitching: where the edges of an open surface lie closer to each other than a stitch length they are joined, before what
// is still open is capped. Patches that were meshed apart meet in other vertices, or in the same ones but for the last
// digits; capped one by one they would carve out the solid between them.
//
// Nothing is moved. Between each open edge and its place on the seam a few facets are added, and what two edges of the
// seam agree on cancels: surface and stitches have a smaller boundary than the surface, and with the caps none. The work
// is by the length of the boundary, not by the surface.
#pragma once
#include <array>
#include <vector>

#include "mesher/closing/boundary.hpp"
#include "mesher/scene/scene.hpp"

namespace teracell {

// How inside is told for a shell: kEvenodd and kDistinct count crossings (kDistinct those of distinct facets only), kNonzero
// sums windings; kAuto is not decided yet.
using ShellRule = Fill;

struct OpenEdge {
  BoundaryEdge edge;
  uint32_t shell;
};

// What was closed by stitches: curves along which boundary edges met.
struct Seams {
  uint64_t number = 0;
  double length = 0;      // of all, in the file's units
  double widest_gap = 0;  // the largest distance between what was joined
  uint64_t collapsed = 0;  // open edges whose ends were joined to one point: what lay within the stitch length
};

// The shells that stitching has joined count as one: a group.
struct Stitched {
  std::vector<ShellRule> rule;               // of each shell: decided
  std::array<std::vector<Facet>, 2> facets;  // the stitches: of winding shells, of shells that count crossings
  struct Group {
    bool by_parity;                   // it counts crossings
    std::vector<BoundaryEdge> left;   // the boundary that is still there, by that rule
  };
  std::vector<Group> groups;
  std::vector<BoundaryEdge> flips;           // left over by winding number, not by parity, whatever the rule
  Seams seams;
};

// `edges` are those of the shells that take part, `rules` those of all shells: of a shell that counts crossings only edges
// that are odd() may come. `stitch` is the length in the file's units; 0: only the groups and rules are found. Distances
// are compared in doubles (ARCHITECTURE.md). InputError, with `name` in front, when more than 64 facets per edge would be needed.
Stitched stitch_boundary(const std::vector<OpenEdge>& edges, std::vector<ShellRule> rules, double stitch, const std::string& name);

}  // namespace teracell
