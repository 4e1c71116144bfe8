// From what a run has found to its report.
#pragma once
#include "mesher/run/plan.hpp"
#include "mesher/run/tile_group.hpp"
#include "store/grid/report.hpp"

namespace teracell::mesher {

// Takes what closing found out of `bodies`. One count per body.
Report make_report(const Scene& scene, Bodies&& bodies, const std::vector<SurfaceCounts>& counts, const Plan& plan, const CastTotals& totals,
                   bool count_thin);

}  // namespace teracell::mesher
