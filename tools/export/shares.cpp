#include "tools/export/shares.hpp"

#include "store/base/error.hpp"

namespace teracell::exports {

std::optional<FractionReader> shares_of(const Export& e) {
  if (!e.has("--fractions")) return {};
  if (e.level != 0) throw UsageError("--fractions: expected --level 0, whose cells have shares, found " + std::to_string(e.level));
  return std::optional<FractionReader>(std::in_place, e.reader);
}

Export step_of(const Export& e, size_t step, size_t steps) {
  Export out = e;
  out.progress = [told = e.progress, step, steps](double share) { told((static_cast<double>(step) + share) / static_cast<double>(steps)); };
  return out;
}

}  // namespace teracell::exports
