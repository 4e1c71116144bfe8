// Pictures in three dimensions of a grid: view.png; what their pixels show, as numbers: view.bin; and what is seen at one point: view.json.
#pragma once
#include <optional>
#include <string_view>

#include "server/service/service.hpp"

namespace teracell::server {

// How to answer "view" with an ending; nothing for an ending that there is none of. Throws HttpError and UsageError for wrong options.
std::optional<Service::Recipe> view_recipe(Service& service, const ServedGrid& grid, const Target& target, std::string_view ending);

}  // namespace teracell::server
