// Requests -> responses (README, "The server"; the addresses are listed in openapi.cpp). Pure but for the files that the
// service reads: no socket, no thread.
#pragma once
#include "server/service.hpp"

namespace teracell {

// Answers any request: what is thrown becomes an error response. Threads may call it at once.
Response handle(Service& service, const Request& request);
// The same when nothing must be read or made for it, so that it needs no thread of its own.
std::optional<Response> handle_at_once(Service& service, const Request& request);

// One file each: other people's protocols. They get the path below their prefix and return 404 with an empty body for
// what does not exist in them.
Response serve_zarr3(Service& service, const Request& request, const Target& target);        // /zarr/{id}/...
Response serve_zarr2(Service& service, const Request& request, const Target& target);        // /zarr2/{id}/...
Response serve_xarray(Service& service, const Request& request, const Target& target);       // /xarray/{id}/{level}/...
Response serve_precomputed(Service& service, const Request& request, const Target& target);  // /precomputed/{id}/...
Response serve_deep_zoom(Service& service, const Request& request, const Target& target);    // /dzi/{id}/{axis}/{index}...
Response serve_iiif(Service& service, const Request& request, const Target& target);         // /iiif/{id}-{axis}-{index}/...

}  // namespace teracell
