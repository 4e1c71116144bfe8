// The page at "/" of a program without the dashboard: the grids that are served, with pictures and with addresses for other clients.
#pragma once
#include <string>

#include "server/service/service.hpp"

namespace teracell::server {

std::string start_page(Service& service, const Request& request);  // HTML

}  // namespace teracell::server
