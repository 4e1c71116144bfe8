// What the report says of cells that bodies don't get: what is lost between sample points, bodies with few cells or none.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "mesher/plan.hpp"
#include "mesher/unit.hpp"

namespace teracell {

// Adds the kind of a sheet, and what is lost of a body between sample points.
void report_lost(const Scene& scene, size_t b, const Plan& plan, const Tallies& tallies, bool count_thin, nlohmann::ordered_json& body);
// Of each material and axis.
nlohmann::ordered_json lost_gaps(const Scene& scene, const Grid& grid, const Tallies& tallies);
// Why bodies have few cells or none (the first 20 of them), and what of sheets lies on the domain's lower side.
std::vector<std::string> cell_warnings(const Scene& scene, const Bodies& bodies, const Plan& plan, const CastTotals& totals);

}  // namespace teracell
