// Which cells of two served grids have different materials: /diff, what `teracell diff --json` prints.
#pragma once
#include "server/service/service.hpp"

namespace teracell::server {

// How to answer "diff?with=ID". Throws HttpError: 400 without `with`, for grids of unequal cells, and where more
// than 65,536 pairs of materials differ; 404 for an id that there is no grid of.
Service::Recipe diff_recipe(Service& service, const ServedGrid& grid, const Target& target);

}  // namespace teracell::server
