// What meshing found, as JSON for people and programs.
#pragma once
#include <string>
#include <vector>

#include "mesher/tiles/binned_counts.hpp"
#include "mesher/plan.hpp"
#include "mesher/tile_group.hpp"

namespace teracell {

struct Report {
  std::string text;                   // JSON
  std::vector<std::string> warnings;  // in it
};

// The report in the file: only what inputs and options determine, so no times, memory or counts of threads. One survey per
// body.
Report make_report(const Scene& scene, const Bodies& bodies, const std::vector<SurveyTotals>& surveys, const Plan& plan, const CastTotals& totals,
                   bool count_thin);

}  // namespace teracell
