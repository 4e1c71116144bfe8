#include "server/protocols/protocol.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "store/text/json_text.hpp"

namespace teracell::server {

Response missing(const char* route) {
  Response r;
  r.status = 404;
  r.cache_control = "no-store";  // a cache on the way must not keep saying that it is missing
  r.body = body_of("");
  r.route = route;
  return r;
}

Response serve_found(const ProtocolRequest& r, const std::string& id, const FindRecipe& find) {
  return or_missing(r.route, [&] {
    const auto grid = r.service.grids().find(id);
    auto recipe = find(*grid, std::span(r.target.path).subspan(2));
    if (!recipe) return missing(r.route);
    recipe->route = r.route;
    // The cache finds answers by their addresses: with queries that mean nothing here it would hold copies of one answer.
    if (std::ranges::any_of(r.target.query, [](const auto& q) { return q.first != "v"; })) recipe->cacheable = false;
    return r.service.answer(r.request, r.target, grid, *recipe);
  });
}

ServeRequest serve_by_id(FindRecipe find) {
  return [find = std::move(find)](const ProtocolRequest& r) {
    if (r.target.path.size() < 2) return missing(r.route);
    return serve_found(r, r.target.path[1], find);
  };
}

std::optional<Service::Recipe> find_document(const Documents& documents, std::string_view path) {
  const auto it = std::ranges::find(documents, path, [](const auto& d) { return std::string_view(d.first); });
  if (it == documents.end()) return std::nullopt;
  return json_recipe(it->second);
}

Service::Recipe json_recipe(std::function<nlohmann::ordered_json()> make) {
  return {.content_type = "application/json", .compress = true, .make = [make = std::move(make)] { return ascii_json(make()); }};
}

std::string joined(std::span<const std::string> path) { return fmt::format("{}", fmt::join(path, "/")); }

std::optional<int> find_level(const Metadata& meta, std::string_view text) {
  const auto level = plain_integer(text);
  return level && *level < meta.grid.levels() ? std::optional(static_cast<int>(*level)) : std::nullopt;
}

}  // namespace teracell::server
