// What other people's protocols share: their addresses are known or unknown, never wrong, and their clients probe for what
// may be there. So an address that means nothing is a 404 with an empty body, and an unknown query is ignored. What is
// there and can't be read stays an error: a client that took it for missing would fill in values.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "server/service.hpp"

namespace teracell {

Response missing(const char* route);

// What serve() returns; missing() when it throws HttpError 404.
template <class F>
Response or_missing(const char* route, F&& serve) {
  try {
    return serve();
  } catch (const HttpError& e) {
    if (e.status != 404) throw;
    return missing(route);
  }
}

// How to make what stands at `path` of a grid; nothing when there is no such thing. `path` begins behind the id.
using Find = std::function<std::optional<Service::Recipe>(const ServedGrid& grid, std::span<const std::string> path)>;
// Answers with what `find` finds, counted as `route`. REQUIRES: target.path has at least two segments.
Response serve_found(Service& service, const Request& request, const Target& target, const char* route, const std::string& id, const Find& find);

// The documents of a hierarchy, by their path in it.
using Documents = std::vector<std::pair<std::string, std::function<nlohmann::ordered_json()>>>;
// REQUIRES: the documents, made when asked for, refer to nothing that dies before the grid.
std::optional<Service::Recipe> find_document(const Documents& documents, std::string_view path);
Service::Recipe json_recipe(std::function<nlohmann::ordered_json()> make);

std::string joined(std::span<const std::string> path);  // by '/'
// The level that `text` names, if the grid has it.
std::optional<int> find_level(const Metadata& meta, std::string_view text);

}  // namespace teracell
