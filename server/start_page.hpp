// The page at "/": the grids that are served, a picture of each, and the addresses under which other clients find them.
#pragma once
#include <string>

#include "server/service.hpp"

namespace teracell {

std::string start_page(Service& service, const Request& request);  // HTML

}  // namespace teracell
