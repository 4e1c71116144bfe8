// The option --fractions of formats that can hold the shares of materials in cells.
#pragma once
#include <optional>

#include "store/channels/fraction_reader.hpp"
#include "tools/export/format.hpp"

namespace teracell::exports {

inline ExportOption shares_option() {
  return {"--fractions", "",
          "the shares of all materials in each cell, too (of a grid meshed with --fractions); meep: the mean epsilon of each cell"};
}

// What the shares are read from; nothing unless the option was given. Throws UsageError if the grid or the level has none.
std::optional<FractionReader> shares_of(const Export& e);

// The export with the share of the work that is done counted as that of one of `steps` equal steps.
Export step_of(const Export& e, size_t step, size_t steps);

}  // namespace teracell::exports
