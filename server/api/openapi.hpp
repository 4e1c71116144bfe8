// The OpenAPI 3.1 description of what the server answers, below /api and beside it.
#pragma once
#include <string>

#include "server/service/message.hpp"

namespace teracell::server {

std::string openapi_json(const Request& request);  // its server is the one that the request was sent to

}  // namespace teracell::server
