// The description of the interface, compared with the answers.
#include "server/api/openapi.hpp"

#include "server/answers/answers.hpp"
#include "server/parts/slice_picture.hpp"
#include "server/render/plane.hpp"
#include "store/check/check.hpp"
#include "store/check/check_json.hpp"
#include "tests/server/served.hpp"

namespace teracell::server {
namespace {

using namespace testing;

// Whether a value has the shape that a schema of openapi.json gives it.
std::string mismatch(const json& schema, const json& value, const json& all, const std::string& where) {
  if (schema.contains("$ref")) return mismatch(all["components"]["schemas"][schema["$ref"].get<std::string>().substr(21)], value, all, where);
  if (!schema.contains("type")) return "";
  const auto is = [&](const std::string& type) {
    return (type == "object" && value.is_object()) || (type == "array" && value.is_array()) || (type == "string" && value.is_string()) ||
           (type == "number" && value.is_number()) || (type == "integer" && value.is_number_integer()) || (type == "boolean" && value.is_boolean()) ||
           (type == "null" && value.is_null());
  };
  bool good = false;
  for (const json& type : schema["type"].is_array() ? schema["type"] : json::array({schema["type"]})) good |= is(type);
  if (!good) return where + " is no " + schema["type"].dump();
  if (value.is_object())
    for (const json& key : schema.value("required", json::array())) {
      if (!value.contains(key)) return where + " has no " + key.get<std::string>();
      if (const auto wrong =
              mismatch(schema["properties"][key.get<std::string>()], value[key.get<std::string>()], all, where + "." + key.get<std::string>());
          !wrong.empty())
        return wrong;
    }
  if (value.is_array()) {
    if (value.size() < schema.value("minItems", size_t{0}) || value.size() > schema.value("maxItems", ~size_t{0}))
      return where + " has " + std::to_string(value.size()) + " items";
    for (const json& item : value)
      if (const auto wrong = mismatch(schema.value("items", json::object()), item, all, where + "[]"); !wrong.empty()) return wrong;
  }
  return "";
}

TEST_CASE("Every answer is described, and what the program fills in", "[server]") {
  Served s;
  const std::string text = *s.get("/openapi.json").body;
  const json api = json::parse(text);
  const auto is_described = [&](const Answer& answer) {
    const std::string path = "/api/v1/grids/{id}" + (answer.name.empty() ? "" : "/" + std::string(answer.name));
    bool found = false;
    for (const auto& [described, get] : api["paths"].items())
      found = found || described == path || described.starts_with(path + "/") || (path.ends_with('.') && described.starts_with(path));
    return found;
  };
#define DESCRIBED(answer) CHECK(is_described(answer));
  TERACELL_ANSWERS(DESCRIBED)
#undef DESCRIBED
  CHECK(text.find("/shared/") == std::string::npos);
  CHECK(text.find("/zarr, ") != std::string::npos);
  CHECK(text.find(std::to_string(kMostOutlined)) != std::string::npos);
  const auto has_all = [&](const char* answer, std::span<const RenderOption> options) {
    std::multiset<std::string> named;
    for (const json& p : api["paths"][std::string("/api/v1/grids/{id}/") + answer]["get"]["parameters"]) named.insert(p["name"]);
    return std::ranges::all_of(options, [&](const RenderOption& option) { return named.count(std::string(option.name)) == 1; });
  };
  CHECK(has_all("view.png", render_options()));
  CHECK(has_all("slice/plane.bin", plane_options()));
}

TEST_CASE("Every address of the description answers as the description says", "[server]") {
  Served s;
  std::ofstream(s.folder / "bad.tcell") << "nothing of a grid";
  std::ofstream(s.folder / "g.check.json") << findings_json(check(GridReader(s.path), {}, [](double) {}));
  s.service->grids().look();
  const json api = s.parsed("/openapi.json");
  CHECK(api["openapi"] == "3.1.0");
  const std::map<std::string, std::string> values = {
      {"id", "g"},       {"axis", "z"},        {"index", "4"},   {"level", "1"},    {"col", "0"},      {"row", "0"},
      {"a", "3"},        {"b", "4"},           {"i", "1"},       {"j", "2"},        {"k", "3"},        {"pixel", "8,8"},
      {"with", "g"},     {"from", "0,3,1"},    {"to", "9,40,9"}, {"size", "64,48"}, {"refine", "3,1"}, {"plane", "30,20,4,20,5"},
      {"cell", "3,4,5"}, {"at", "0.75,3.1,6"}, {"labels", "0,2"}};
  size_t seen = 0;
  for (const auto& [path, operations] : api["paths"].items()) {
    const json& responses = operations["get"]["responses"];
    CHECK(responses.contains("405"));
    CHECK(responses.contains("401") == (path != "/healthz" && path != "/NOTICE"));
    const bool of_routes = path != "/healthz" && path != "/metrics" && path != "/NOTICE";  // other handlers answer these
    CHECK(responses.contains("503") == of_routes);
    if (!of_routes) continue;
    INFO(path);
    std::string target = path, query;
    for (const json& p : operations["get"]["parameters"]) {
      const std::string name = p["name"];
      if (p["in"] == "path") {
        REQUIRE(p["required"] == true);
        const std::string place = "{" + name + "}";
        REQUIRE(target.find(place) != std::string::npos);
        target.replace(target.find(place), place.size(), values.at(name));
      } else if (p["required"] == true || name == "size") {
        query += (query.empty() ? "?" : "&") + name + "=" + values.at(name);
      }
    }
    REQUIRE(target.find('{') == std::string::npos);
    const Response r = s.get(target + query);
    REQUIRE(r.status == 200);
    const json& content = operations["get"]["responses"]["200"]["content"];
    REQUIRE(content.size() == 1);
    REQUIRE(r.content_type == content.begin().key());
    if (content.begin().value().contains("schema")) {
      const std::string wrong = mismatch(content.begin().value()["schema"], json::parse(*r.body), api, path);
      INFO(wrong);
      REQUIRE(wrong.empty());
    }
    const Response error = s.get(target + query + (query.empty() ? "?" : "&") + "no_such_parameter=1");
    if (path != "/openapi.json") {
      REQUIRE(error.status == 400);
      REQUIRE(mismatch(operations["get"]["responses"]["400"]["content"]["application/json"]["schema"], json::parse(*error.body), api, path).empty());
    }
    ++seen;
  }
  CHECK(seen + 3 == api["paths"].size());
  CHECK(api["paths"].contains("/NOTICE"));
}

}  // namespace
}  // namespace teracell::server
