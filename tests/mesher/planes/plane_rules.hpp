// The rules for planes that are made, as users read them in mesher/SCENES.md. It knows nothing of how they are made.
#pragma once
#include "mesher/scene/scene.hpp"
#include "store/grid/report.hpp"
#include "tests/support/shapes.hpp"

namespace teracell::testing {

struct RuledBody {
  std::string name, material;
  shapes::Facets facets;  // as the grid sees them
};

struct RuledAxis {
  mesher::AutoPlanes rules;
  std::optional<std::array<double, 2>> domain;
  int axis = 0;
};

struct Verdict {
  std::vector<std::string> broken;  // what the rules don't allow, in words
  double cells = 0, ideal = 0;      // S of the rules
  size_t gaps = 0;
  bool symmetric = false;           // kept candidates and widths are
};

// `breaches`: those that are listed, of this axis.
Verdict judge(const RuledAxis& of, const std::vector<RuledBody>& bodies, const std::vector<double>& planes, const std::vector<PlaneBreach>& breaches);

}  // namespace teracell::testing
