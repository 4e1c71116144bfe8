// What protocols of other programs share. Their clients probe for what may be there. So an address that means nothing gets
// status 404 with an empty body, and an unknown query parameter is ignored. Data that exists and can't be read stays an error: a
// client that took it for missing would show fill values instead.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "server/service/service.hpp"

namespace teracell::server {

// What a protocol is asked. It is valid during the call.
struct ProtocolRequest {
  Service& service;
  const Request& request;
  const Target& target;
  const char* route;  // of the protocol
};
using ServeRequest = std::function<Response(const ProtocolRequest&)>;

// One protocol: where it is, what people and metrics call it, and how it answers. Its file defines one; protocols.hpp lists all.
struct Protocol {
  const char* prefix;                           // the first segment of its addresses: "zarr" of "/zarr/{id}/..."
  const char* route;                            // in metrics and the log
  const char* title;                            // for people
  // The rest of the address that the other program is given: "/g".
  std::string (*address)(const ServedGrid& g) = [](const ServedGrid& g) { return "/" + percent_encoded(g.id); };
  const char* document = "";                    // what to append for an address that a browser can open: "/zarr.json"
  ServeRequest serve;                           // threads call it at once
  bool dear = false;                            // whether an answer may read much of a grid
};

// Below the server's base path: "/zarr/g".
inline std::string address_of(const Protocol& p, const ServedGrid& g) { return std::string("/") + p.prefix + p.address(g); }

// Status 404 with an empty body.
Response missing(const char* route);

// What serve() returns, or missing() when it throws HttpError 404.
template <class F>
Response or_missing(const char* route, F&& serve) {
  try {
    return serve();
  } catch (const HttpError& e) {
    if (e.status != 404) throw;
    return missing(route);
  }
}

// The recipe for what stands at `path` of a grid; none when there is no such thing. `path` begins after the id.
using FindRecipe = std::function<std::optional<Service::Recipe>(const ServedGrid& grid, std::span<const std::string> path)>;
// Answers with the recipe that `find` returns. REQUIRES: target.path has at least two segments.
Response serve_found(const ProtocolRequest& r, const std::string& id, const FindRecipe& find);
// Protocol::serve for addresses "/{prefix}/{id}/{path}".
ServeRequest serve_by_id(FindRecipe find);

// The documents of a hierarchy, each with its path and a function that makes it.
using Documents = std::vector<std::pair<std::string, std::function<nlohmann::ordered_json()>>>;
// REQUIRES: the functions refer to nothing that dies before the grid.
std::optional<Service::Recipe> find_document(const Documents& documents, std::string_view path);
Service::Recipe json_recipe(std::function<nlohmann::ordered_json()> make);

std::string joined(std::span<const std::string> path);  // with '/'
// The level that `text` names, if the grid has it.
std::optional<int> find_level(const Metadata& meta, std::string_view text);

}  // namespace teracell::server
