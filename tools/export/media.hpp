// What electromagnetic solvers are told of a material, as the options --epsilon, --sigma and --mu give it.
#pragma once
#include "tools/export/format.hpp"

namespace teracell::exports {

struct Medium {
  bool given = false;  // by --epsilon; else it is the background, or occurs nowhere
  double epsilon = 1;  // relative permittivity
  double sigma = 0;    // electric conductivity in S/m; infinite: a perfect conductor
  double mu = 1;       // relative permeability
};

std::vector<ExportOption> media_options();

// By material id. Throws UsageError unless --epsilon names all materials with cells in the box. The background may be left out
// unless `all` are wanted.
std::vector<Medium> media_of(const Export& e, bool all);

}  // namespace teracell::exports
