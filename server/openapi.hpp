// The OpenAPI 3.1 description of what routes.cpp answers.
#pragma once
#include <string>

#include "server/http.hpp"

namespace teracell {

std::string openapi_json(const Request& request);  // its server is where the request went

}  // namespace teracell
