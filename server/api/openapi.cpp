#include "server/api/openapi.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "server/parts/slice_picture.hpp"
#include "server/protocols/protocols.hpp"
#include "server/render/plane.hpp"

namespace teracell::server {
namespace {

using nlohmann::ordered_json;

// `value` with what "shared" has in place of what refers to it.
ordered_json whole(ordered_json value, const ordered_json& shared) {
  constexpr std::string_view kShared = "#/shared/";
  if (const std::string ref = value.is_object() ? value.value("$ref", "") : ""; ref.starts_with(kShared)) {
    value.erase("$ref");
    ordered_json merged = whole(shared.at(ref.substr(kShared.size())), shared);
    merged.merge_patch(value);
    value = std::move(merged);
  }
  if (value.is_structured())
    for (ordered_json& inner : value) inner = whole(std::move(inner), shared);
  return value;
}

// Puts `value` in place of the {} of a text.
void fill_in(ordered_json& text, const std::string& value) {
  std::string filled = text;
  filled.replace(filled.find("{}"), 2, value);
  text = filled;
}

ordered_json parameters_of(std::span<const RenderOption> options, std::string_view required = "") {
  ordered_json out = ordered_json::array();
  for (const RenderOption& o : options) {
    const bool is_flag = o.value.empty();
    ordered_json schema = {{"type", "string"}};
    if (is_flag) schema = {{"type", "integer"}, {"enum", {0, 1}}};
    out.push_back({{"name", o.name},
                   {"in", "query"},
                   {"required", o.name == required},
                   {"description", fmt::format("{}: {}", is_flag ? "1" : o.value, o.help)},
                   {"schema", std::move(schema)}});
  }
  return out;
}

}  // namespace

std::string openapi_json(const Request& request) {
  ordered_json out = ordered_json::parse(openapi_file());
  std::vector<std::string> prefixes;
  for (const Protocol& p : protocols()) prefixes.push_back(fmt::format("/{}", p.prefix));
  fill_in(out["info"]["description"], fmt::format("{}", fmt::join(prefixes, ", ")));
  fill_in(out["shared"]["outline"]["description"], std::to_string(kMostOutlined));
  const auto add = [&](const char* answer, const ordered_json& options) {
    ordered_json& parameters = out["paths"][fmt::format("/api/v1/grids/{{id}}/{}", answer)]["get"]["parameters"];
    parameters.insert(parameters.begin() + 2, options.begin(), options.end());  // after the grid and its version
  };
  for (const char* answer : {"view.png", "view.bin", "view.json"}) add(answer, parameters_of(render_options()));
  for (const char* answer : {"slice/plane.png", "slice/plane.bin"}) add(answer, parameters_of(plane_options(), "plane"));
  const ordered_json shared = std::move(out["shared"]);
  out.erase("shared");
  out["servers"].push_back({{"url", request.prefix.empty() ? "/" : request.prefix}});
  return whole(std::move(out), shared).dump();
}

}  // namespace teracell::server
