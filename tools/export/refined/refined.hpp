// What exports of refined grids have in common: their options, and what they are told by them.
#pragma once
#include <memory>

#include "store/refine/leaves.hpp"
#include "tools/export/format.hpp"

namespace teracell::exports {

// --refine, --want, --threads and --tmp, and those of the format itself.
std::vector<ExportOption> refined_options(std::vector<ExportOption> own = {});

// Throws UsageError if options of refined grids were given without --refine.
void expect_refined(const Export& e);

// The leaves of the export's box, prepared, and what is written for their labels.
class RefinedGrid {
 public:
  // `share`: of the progress that preparing takes. Throws UsageError. REQUIRES: --refine was given.
  RefinedGrid(const Export& e, double share);

  const Refinement& refinement() const { return refinement_; }
  int threads() const { return threads_; }
  const Leaves& leaves() const { return *leaves_; }
  // By label: the id of its material, or what Export::map has for it.
  const std::vector<uint32_t>& numbers() const { return numbers_; }

 private:
  Refinement refinement_;
  int threads_;
  std::unique_ptr<Leaves> leaves_;
  std::vector<uint32_t> numbers_;
};

}  // namespace teracell::exports
