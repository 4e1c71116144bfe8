// What a user should know about the bodies and their cells, in sentences: what was wrong, what was done, and whether to care.
#pragma once
#include <string>
#include <vector>

#include "mesher/plan.hpp"
#include "mesher/tile_group.hpp"

namespace teracell {

// A length in cells where they are narrowest, near `at`.
double in_cells(double length, const Vec3& at, const Grid& grid);
// "(1, 2.5, 0)", to six digits.
std::string text(const Vec3& p);

// Of a body's surface: each begins behind "body NAME".
std::vector<std::string> surface_warnings(const Scene& scene, const SceneBody& body, const BodyFacets& found, const Grid& grid, const SurfaceCounts& counts);
// Why bodies have few cells or none (the first 20 of them), and which sheets lie on the domain's lower side.
std::vector<std::string> cell_warnings(const Scene& scene, const Bodies& bodies, const Plan& plan, const CastTotals& totals);

}  // namespace teracell
