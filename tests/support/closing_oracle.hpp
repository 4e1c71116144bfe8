// How an open surface is closed: stitches, then caps, and the fill rule of each shell. A second reading of the rules, slow
// and simple, that shares nothing with the mesher but its types: what the two agree on is what the rules say.
#pragma once
#include "mesher/scene/scene.hpp"
#include "mesher/surface/facet.hpp"
#include "tests/support/test.hpp"

namespace teracell::oracle {

// Shells that count as one, and what became of them.
struct JoinedShell {
  size_t shells = 1;         // of the surface as given
  bool evenodd = false;      // the rule
  bool distinct = false;     // one of its shells counts equal facets once
  size_t boundary = 0;       // edges that were open before stitching, by the rule
  size_t open = 0;           // and after it
  size_t loops = 0;          // that these were cut into
};

struct ClosedSurface {
  std::vector<mesher::Facet> nonzero, evenodd;  // the facets that count, the stitches and the caps, by rule
  std::vector<JoinedShell> shells;
  size_t stitches = 0;                  // facets
};

// Closes the facets of a body, in the coordinates of its file. `tau` is the stitch length there: 0 for no stitches.
// Throws std::length_error where the rules forbid so many stitches.
ClosedSurface closed(const std::vector<mesher::Facet>& facets, Fill fill, double tau, bool float32);

// The stitch length in the file's coordinates, for one in the grid's.
double stitch_in_file(double stitch, const mesher::Matrix& matrix);

}  // namespace teracell::oracle
