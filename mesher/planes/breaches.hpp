// Where planes break the rules that they were made by, because two rules collide there.
#pragma once
#include <vector>

#include "mesher/planes/widths.hpp"
#include "mesher/scene/auto_planes.hpp"
#include "store/grid/report.hpp"

namespace teracell::mesher {

// Looks at the planes alone, whatever made them.
void add_breaches(int axis, const std::vector<double>& planes, const std::vector<double>& kept, const Widths& widths, const AutoPlanes& rules,
                  PlanesReport& out);

}  // namespace teracell::mesher
