#include "server/api/openapi.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "server/parts/slice_picture.hpp"
#include "server/protocols/protocols.hpp"
#include "server/render/options.hpp"

namespace teracell::server {
namespace {

using nlohmann::ordered_json;

ordered_json parameter(const char* name, const char* in, const std::string& description, ordered_json schema) {
  return {{"name", name}, {"in", in}, {"required", std::string(in) == "path"}, {"description", description}, {"schema", std::move(schema)}};
}

const ordered_json kInteger = {{"type", "integer"}, {"minimum", 0}};
const ordered_json kString = {{"type", "string"}};
ordered_json flag() { return {{"type", "integer"}, {"enum", {0, 1}}}; }

ordered_json grid_id() { return parameter("id", "path", "the id of the grid, as /api/v1/grids lists it", kString); }
ordered_json axis() {
  return parameter("axis", "path", "the axis normal to the slice, or along the column", {{"type", "string"}, {"enum", {"x", "y", "z"}}});
}
ordered_json version() { return parameter("v", "query", "the grid's hash; with it the answer may be cached for ever", kString); }
ordered_json level(const char* in) {
  return parameter("level", in, "the level of the pyramid; its cells are 2^level times as wide as those of level 0", kInteger);
}
ordered_json materials() { return parameter("materials", "query", "ids of the materials to show, separated by commas; default: all", kString); }
ordered_json outline() {
  return parameter("outline", "query", fmt::format("1: draws the boundaries between materials, in pictures of at most {} pixels", kMostOutlined),
                   flag());
}

ordered_json shares() {
  return parameter(
      "shares", "query",
      "1: mixed cells of level 0 by their shares, where the grid has fractions; with sets=1, or in pictures of the size that outline allows", flag());
}

ordered_json content(const char* type, const char* schema) {
  ordered_json c = {{type, ordered_json::object()}};
  if (schema) c[type]["schema"] = {{"$ref", std::string("#/components/schemas/") + schema}};
  return c;
}

// What an answer depends on: the server alone (it comes at once), the list of grids, or one grid (it has an ETag).
enum class Source { kServer, kGrids, kGrid };

ordered_json get(const char* summary, ordered_json parameters, const char* type, const char* schema, Source source = Source::kGrid) {
  ordered_json responses = {{"200", {{"description", "the answer"}, {"content", content(type, schema)}}}};
  const auto error = [&](const char* status, const char* description) {
    responses[status] = {{"description", description}, {"content", content("application/json", "Error")}};
  };
  error("400", "a value is malformed or out of range; the message names the range");
  error("401", "the request has no token, or a wrong one");
  if (source == Source::kGrid) {
    responses["200"]["headers"] = {
        {"ETag", {{"description", "strong: changes with the grid's content and the encoding"}, {"schema", {{"type", "string"}}}}}};
    responses["304"] = {{"description", "the client has this answer already"}};
    error("404", "there is no such grid, tile or version");
    error("500", "the file is damaged at this place");
  }
  error("405", "the method is none of GET, HEAD and OPTIONS");
  error("421", "the request is for a host that this server does not answer to (--allow-host)");
  if (source != Source::kServer) error("503", "too many requests wait, or memory is short; try again in a second");
  return {{"get", {{"summary", summary}, {"parameters", std::move(parameters)}, {"responses", responses}}}};
}

ordered_json object(ordered_json properties) {
  ordered_json required = ordered_json::array();
  for (const auto& [key, value] : properties.items()) required.push_back(key);
  return {{"type", "object"}, {"required", required}, {"properties", std::move(properties)}};
}
ordered_json described(ordered_json schema, const char* description) {
  schema["description"] = description;
  return schema;
}
ordered_json with_optional(const char* name, ordered_json schema, const char* description, ordered_json object) {
  object["properties"][name] = described(std::move(schema), description);
  return object;
}
ordered_json nullable(const char* type) {
  ordered_json out;
  out["type"] = ordered_json::array({type, "null"});
  return out;
}
ordered_json array(ordered_json items) { return {{"type", "array"}, {"items", std::move(items)}}; }
const ordered_json kNumber = {{"type", "number"}};

ordered_json schemas() {
  const ordered_json text = {{"type", "string"}}, three = {{"type", "array"}, {"items", kNumber}, {"minItems", 3}, {"maxItems", 3}};
  const ordered_json index = {{"type", "array"}, {"items", kInteger}, {"minItems", 3}, {"maxItems", 3}};
  const ordered_json box = {{"type", "array"}, {"items", kInteger}, {"minItems", 6}, {"maxItems", 6}};
  ordered_json box_or_null = box;
  box_or_null["type"] = {"array", "null"};
  return {
      {"Error", object({{"error", object({{"code", text}, {"message", text}})}})},
      {"Grids",
       object({{"schema", kInteger},
               {"grids",
                array(object({{"id", text},
                              {"name", text},
                              {"cells", index},
                              {"bytes", kInteger},
                              {"hash", text},
                              {"units", text},
                              {"modified", described(nullable("integer"), "seconds since 1970; null for a grid behind an address")},
                              {"checked", {{"type", "boolean"}}},
                              {"protocols",
                               array(object({{"title", text},
                                             {"path", described(text, "below the server's base path, for programs that read this protocol")}}))}}))},
               {"unreadable", array(object({{"id", text}, {"error", text}}))}})},
      {"Info",
       with_optional(
           "labels", array(object({{"material", kInteger}, {"body", text}})), "where the file keeps bodies apart",
           object({{"schema", kInteger},
                   {"id", text},
                   {"units", text},
                   {"ray_axis", text},
                   {"grid", object({{"min", three}, {"max", three}, {"cells", index}, {"sample", three}, {"axes", array({{"type", "object"}})}})},
                   {"materials", array(object({{"id", kInteger}, {"name", text}, {"color", text}, {"rank", kInteger}}))},
                   {"levels",
                    array(object(
                        {{"level", kInteger}, {"cells", index}, {"stored", {{"type", "boolean"}}}, {"chunks", kInteger}, {"bytes", kInteger}}))},
                   {"file", object({{"bytes", kInteger}, {"version", text}, {"hash", text}})},
                   {"crossings", kInteger},
                   {"bits_per_crossing", kNumber},
                   {"report", {{"type", "object"}}}}))},
      {"Cell", object({{"schema", kInteger},
                       {"index", index},
                       {"level", kInteger},
                       {"centre", three},
                       {"materials", array(object({{"id", kInteger}, {"name", text}}))}})},
      {"Column",
       object({{"schema", kInteger},
               {"axis", text},
               {"at", {{"type", "array"}, {"items", kInteger}, {"minItems", 2}, {"maxItems", 2}}},
               {"runs",
                array(object({{"from", kInteger}, {"to", kInteger}, {"min", kNumber}, {"max", kNumber}, {"material", kInteger}, {"name", text}}))}})},
      {"Line",
       object(
           {{"schema", kInteger},
            {"from", array(kNumber)},
            {"to", array(kNumber)},
            {"length", kNumber},
            {"runs", array(object(
                         {{"from", kNumber}, {"to", kNumber}, {"length", kNumber}, {"cells", kInteger}, {"material", kInteger}, {"name", text}}))}})},
      {"Stats",
       object({{"schema", kInteger},
               {"region", box},
               {"materials", array(object({{"id", kInteger}, {"name", text}, {"cells", kNumber}, {"volume", kNumber}, {"box", box_or_null}}))}})},
      {"Findings",
       object({{"schema", kInteger},
               {"grid_hash", text},
               {"findings", array(object({{"kind", text},
                                          {"level", text},
                                          {"bodies", array(text)},
                                          {"cells", kNumber},
                                          {"at", nullable("array")},
                                          {"box", box_or_null},
                                          {"text", text}}))},
               {"totals", {{"type", "object"}}},
               {"walls",
                array(object({{"body", text}, {"thinnest_cells", nullable("integer")}, {"at", nullable("array")}, {"histogram", array(kNumber)}}))},
               {"not_looked_at", array(text)}})},
      {"Difference", object({{"schema", kInteger},
                             {"cells", kNumber},
                             {"same", kNumber},
                             {"changes", array(object({{"from", text}, {"to", text}, {"cells", kNumber}, {"box", box}}))}})},
      {"Seen", object({{"schema", kInteger}, {"seen", nullable("object")}})},
  };
}

std::string description() {
  std::vector<std::string> prefixes;
  for (const Protocol& p : protocols()) prefixes.push_back(fmt::format("/{}", p.prefix));
  return fmt::format(
      "Slices, columns and statistics of huge Cartesian grids. Other programs find the same grids below {}. HEAD is answered like GET, without the body.",
      fmt::join(prefixes, ", "));
}

}  // namespace

std::string openapi_json(const Request& request) {
  const ordered_json id = grid_id();
  const std::string grid = "/api/v1/grids/{id}";
  ordered_json paths;
  const auto open = [](ordered_json path) {  // needs no token
    path["get"]["responses"].erase("401");
    path["get"]["security"] = ordered_json::array();
    return path;
  };
  paths["/healthz"] = open(get("whether the server is alive", ordered_json::array(), "application/json", nullptr, Source::kServer));
  paths["/NOTICE"] =
      open(get("the licences of what is embedded in the program and linked to it", ordered_json::array(), "text/plain", nullptr, Source::kServer));
  paths["/metrics"] = get("counters for Prometheus", ordered_json::array(), "text/plain", nullptr, Source::kServer);
  paths["/openapi.json"] = get("this description", ordered_json::array(), "application/json", nullptr, Source::kGrids);
  paths["/api/v1/grids"] =
      get("the grids that are served, and files that can't be read", ordered_json::array(), "application/json", "Grids", Source::kGrids);
  paths[grid] = get("a grid: its axes, materials and levels, and the report of the mesher", {id, version()}, "application/json", "Info");
  paths[grid + "/slice/{axis}/{index}.png"] =
      get("a slice as a picture, v upwards",
          {id, axis(), parameter("index", "path", "the index of the slice, in cells of the level", kInteger), level("query"),
           parameter("region", "query", "U0,V0,U1,V1: half open, in cells of the level", kString), materials(), outline(), shares(), version()},
          "image/png", nullptr);
  const auto tile = [&](const ordered_json& more) {
    ordered_json p = {id,
                      axis(),
                      parameter("index", "path", "the index of the slice, in cells of the level", kInteger),
                      level("path"),
                      parameter("col", "path", "the column of the tile, counted from u = 0", kInteger),
                      parameter("row", "path", "the row of the tile, counted from v = 0", kInteger)};
    for (auto& m : more) p.push_back(m);
    return p;
  };
  paths[grid + "/tile/{axis}/{index}/{level}/{col}_{row}.png"] =
      get("a tile of 512 x 512 cells as a picture, v upwards; tiles at the edge are smaller", tile({materials(), outline(), shares(), version()}),
          "image/png", nullptr);
  paths[grid + "/tile/{axis}/{index}/{level}/{col}_{row}.bin"] = get(
      "a tile as labels, the row with the lowest v first. Each cell is the id of its strongest material: one byte, or two (little endian) in grids of more than 256 materials. With "
      "sets=1 there are, all little endian: the number of sets (u32); for each set its number of materials and their ids (u16 each); for each cell the number of its set, one byte, "
      "or two when there are more than 256 sets",
      tile(
          {parameter("sets", "query", "1: gives the set of all materials in each coarse cell", flag()),
           parameter(
               "bodies", "query",
               "1, with sets=1: labels in place of materials, where the grid keeps bodies apart. The upper half of the number of sets has flags then: 1: numbers in sets have "
               "four bytes; 2: more sets than can be numbered, so each label is replaced by the first one of its material",
               flag()),
           shares(), version()}),
      "application/octet-stream", nullptr);
  paths[grid + "/cell"] = get("the materials of a cell",
                              {id, parameter("i", "query", "along x", kInteger), parameter("j", "query", "along y", kInteger),
                               parameter("k", "query", "along z", kInteger), level("query"), version()},
                              "application/json", "Cell");
  for (auto& p : paths[grid + "/cell"]["get"]["parameters"])
    if (p["name"] == "i" || p["name"] == "j" || p["name"] == "k") p["required"] = true;
  paths[grid + "/column/{axis}/{a}_{b}"] =
      get("the runs of a column of cells",
          {id, axis(), parameter("a", "path", "the cell's index along the first of the other two axes", kInteger),
           parameter("b", "path", "the cell's index along the second one", kInteger),
           parameter("from", "query", "the first cell along the column; default: 0", kInteger),
           parameter("to", "query", "the cell behind the last one; default: the column's end", kInteger), version()},
          "application/json", "Column");
  const auto point = [](const char* name, const char* help) {
    ordered_json p = parameter(name, "query", help, kString);
    p["required"] = true;
    return p;
  };
  paths[grid + "/line"] =
      get("the materials along a straight line, as runs with lengths from its first point; where it lies outside the grid there is none",
          {id, point("from", "X,Y,Z: coordinates of the first point"), point("to", "X,Y,Z: coordinates of the last point"), version()},
          "application/json", "Line");
  const ordered_json region = parameter("region", "query", "X0,Y0,Z0,X1,Y1,Z1: half open, in cells; default: the whole grid", kString);
  for (const char* ending : {"npy", "vti", "vtr"})
    paths[fmt::format("{}/box.{}", grid, ending)] = get(
        fmt::format("the material ids of a box, at most 2^32 cells, as {}", std::string(ending) == "npy"   ? "a NumPy array [z][y][x]"
                                                                            : std::string(ending) == "vti" ? "a file of VTK, for uniform axes"
                                                                                                           : "a file of VTK, also for graded axes")
            .c_str(),
        {id, region, version()}, std::string(ending) == "npy" ? "application/octet-stream" : "application/xml", nullptr);
  paths[grid + "/file.tcell"] = get("the grid's file as it is", {id, version()}, "application/octet-stream", nullptr);
  paths[grid + "/stats"] = get("the exact number of cells, volume and box of every material, counted from runs",
                               {id, parameter("region", "query", "X0,Y0,Z0,X1,Y1,Z1: half open, in cells; default: the whole grid", kString),
                                parameter("bodies", "query", "1: also those of every body, where the grid keeps bodies apart", flag()), version()},
                               "application/json", "Stats");
  paths[grid + "/check"] = get("what `teracell check` has found: walls, islands, overlaps, holes ...; 404 when it has not been run",
                               ordered_json::array({id}), "application/json", "Findings");
  ordered_json with = parameter("with", "query", "the id of the other grid", kString);
  with["required"] = true;
  paths[grid + "/diff"] =
      get("which cells have a material of another name in another grid of equal cells, by pair of names: exact, as `teracell diff` counts",
          ordered_json::array({id, with}), "application/json", "Difference");
  ordered_json view = {id, version()};
  for (const RenderOption& o : render_options()) {
    const std::string name(o.name), help(o.value.empty() ? fmt::format("1: {}", o.help) : fmt::format("{}: {}", o.value, o.help));
    view.push_back(parameter(name.c_str(), "query", help, o.value.empty() ? flag() : kString));
  }
  paths[grid + "/view.png"] =
      get("a picture in three dimensions: the first visible cell on the line of sight of each pixel", view, "image/png", nullptr);
  const auto and_also = [&](std::initializer_list<ordered_json> more) {
    ordered_json p = view;
    for (const ordered_json& m : more) p.push_back(m);
    return p;
  };
  paths[grid + "/view.bin"] = get("what the pixels of such a picture show, as numbers: SERVING.md describes the bytes",
                                  and_also({parameter("window", "query", "X0,Y0,X1,Y1: half open, in pixels; default: the whole picture", kString),
                                            parameter("quick", "query", "1: one line of sight per pixel", flag())}),
                                  "application/octet-stream", nullptr);
  ordered_json pixel = parameter("pixel", "query", "X,Y in pixels from the upper left corner of the picture, as in 320.5,240.5", kString);
  pixel["required"] = true;
  paths[grid + "/view.json"] = get("what is seen at a point of such a picture", and_also({pixel}), "application/json", "Seen");
  const ordered_json bearer = {{"type", "http"}, {"scheme", "bearer"}, {"description", "needed when the server was started with a token"}};
  const ordered_json out = {{"openapi", "3.1.0"},
                            {"info", {{"title", "teracell"}, {"version", "1"}, {"description", description()}}},
                            {"servers", {{{"url", request.prefix.empty() ? "/" : request.prefix}}}},
                            {"paths", paths},
                            {"security", {ordered_json::object(), {{"bearer", ordered_json::array()}}}},  // no token, or this one
                            {"components", {{"schemas", schemas()}, {"securitySchemes", {{"bearer", bearer}}}}}};
  return out.dump();
}

}  // namespace teracell::server
