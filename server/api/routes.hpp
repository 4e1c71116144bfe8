// From requests to responses (the addresses: SERVING.md and openapi.json). Nothing here knows a socket or a thread; the service
// reads files.
#pragma once
#include "server/service/handler.hpp"
#include "server/service/service.hpp"

namespace teracell::server {

// Answers any request: exceptions become error responses. Threads may call it at once.
Response handle(Service& service, const Request& request);
// The same for an answer that is in the cache, so that it needs no thread of its own.
std::optional<Response> handle_at_once(Service& service, const Request& request);

// Both as a handler. REQUIRES: the service outlives it.
Handler handler_of(Service& service);

}  // namespace teracell::server
