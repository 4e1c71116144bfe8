// The option --fractions of formats that can hold the shares of materials in cells.
#pragma once
#include <optional>

#include "store/base/error.hpp"
#include "store/channels/fraction_reader.hpp"
#include "tools/export/format.hpp"

namespace teracell::exports {

inline ExportOption shares_option() {
  return {"--fractions", "",
          "the shares of all materials in each cell, too (of a grid meshed with --fractions); meep: the mean epsilon of each cell"};
}

// What the shares are read from; nothing unless the option was given. Throws UsageError if the grid or the level has none.
inline std::optional<FractionReader> shares_of(const Export& e) {
  if (!e.has("--fractions")) return {};
  if (e.level != 0) throw UsageError("--fractions: expected --level 0, whose cells have shares, found " + std::to_string(e.level));
  return std::optional<FractionReader>(std::in_place, e.reader);
}

// The export with the share of the work that is done counted as that of one of `steps` equal steps.
inline Export step_of(const Export& e, size_t step, size_t steps) {
  Export out = e;
  out.progress = [told = e.progress, step, steps](double share) { told((static_cast<double>(step) + share) / static_cast<double>(steps)); };
  return out;
}

}  // namespace teracell::exports
