// Warnings in sentences: what was found and where, what was done about it, whether it matters, and what the user can do.
#pragma once
#include <string>
#include <vector>

#include "mesher/run/plan.hpp"
#include "mesher/run/tile_group.hpp"

namespace teracell::mesher {

// A length as a number of cells: the cell at `at`, along the axis on which it is shortest.
double in_cells(double length, const Vec3& at, const Grid& grid);
// "(1, 2.5, 0)", to six digits.
std::string text(const Vec3& p);

// Warnings about a body's surface. The caller puts "body NAME" in front of each.
std::vector<std::string> surface_warnings(const Scene& scene, const SceneBody& body, const BodyFacets& found, const Grid& grid,
                                          const SurfaceCounts& counts);
// Why bodies own few cells or none (for the first 20 of them), and which sheets lie on the domain's lower side.
std::vector<std::string> cell_warnings(const Scene& scene, const Bodies& bodies, const Plan& plan, const CastTotals& totals);

}  // namespace teracell::mesher
