// What is answered about the grids that are served: the addresses below /api/v1/grids (SERVING.md and openapi.json). Nothing here knows a
// socket, a thread or a page: the page's module, which answers in the browser, stands on this, too (web/module).
#pragma once
#include <functional>
#include <span>

#include "server/protocols/protocol.hpp"
#include "server/service/handler.hpp"

namespace teracell::server {

// Answers a request for an address below /api. `protocols`: those at whose addresses the grids are found as well. Throws HttpError, and what
// reading throws.
Response answer_api(Service& service, const Request& request, const Target& target, std::span<const Protocol> protocols);
// Of an address below /api.
Cost cost_of_api(const Target& target);

HttpError no_such_address(const Request& request);

// What answer() returns; exceptions become error responses, but for Unwanted. After Replaced it is called once more.
Response answered(Service& service, const std::function<Response()>& answer);

}  // namespace teracell::server
