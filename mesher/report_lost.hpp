// What the report says of cells that bodies don't get: what is lost between sample points, bodies with few cells or none.
#pragma once
#include <string>
#include <vector>

#include "mesher/plan.hpp"
#include "mesher/tile_group.hpp"
#include "store/json_writer.hpp"

namespace teracell {

// Within the object of a body: the kind of a sheet, and what is lost between sample points.
void write_lost(JsonWriter& out, const Scene& scene, size_t b, const Plan& plan, const Tallies& tallies, bool count_thin);
// A list: of each material and axis.
std::string lost_gaps(const Scene& scene, const Grid& grid, const Tallies& tallies);
// Why bodies have few cells or none (the first 20 of them), and what of sheets lies on the domain's lower side.
std::vector<std::string> cell_warnings(const Scene& scene, const Bodies& bodies, const Plan& plan, const CastTotals& totals);

}  // namespace teracell
