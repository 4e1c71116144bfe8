// The OpenAPI 3.1 description of what the server answers, below /api and beside it.
#pragma once
#include <string>
#include <string_view>

#include "server/service/message.hpp"

namespace teracell::server {

std::string openapi_json(const Request& request);  // its server is the one that the request was sent to

// openapi.json as it is in the sources (openapi_file.cpp). There, {"$ref": "#/shared/NAME"} stands for a member of "shared", with what else the
// object has merged into it: null takes away.
std::string_view openapi_file();

}  // namespace teracell::server
