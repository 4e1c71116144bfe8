// Reads and writes the scene file. Reading takes two steps: the text becomes JsonNodes that know their path (json_node.hpp), then each
// part of the scene is taken from its JsonNode here.
#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <set>
#include <unordered_map>

#include <fmt/format.h>

#include "mesher/scene/names.hpp"
#include "mesher/scene/scene.hpp"
#include "store/base/error.hpp"
#include "store/grid/metadata.hpp"
#include "store/text/color.hpp"
#include "store/text/json_node.hpp"
#include "store/text/json_writer.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostSceneText = 64'000'000;  // as many planes as fit into a .tcell file; a device would never end

std::string read_text(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) throw IoError(fmt::format("{}: expected a file, found a folder", path.string()), EISDIR);
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (const int error = errno; !in.is_open()) throw IoError(fmt::format("{}: can't be opened: {}", path.string(), std::strerror(error)), error);
  std::string text;
  for (char block[1 << 16]; in.read(block, sizeof block), in.gcount() > 0;) {
    text.append(block, static_cast<size_t>(in.gcount()));
    if (text.size() > kMostSceneText)
      throw InputError(fmt::format("{}: expected at most {} bytes of text, found more", path.string(), kMostSceneText));
  }
  if (in.bad()) throw IoError(fmt::format("{}: can't be read", path.string()));
  return text;
}

void check_planes(const std::vector<double>& planes, const std::string& where) {
  if (planes.size() < 2) throw UsageError(fmt::format("{}: expected at least 2 planes, found {}", where, planes.size()));
  for (size_t i = 1; i < planes.size(); ++i)
    if (!(planes[i - 1] < planes[i]))
      throw UsageError(fmt::format("{}: expected planes that ascend strictly, found {} as plane {} after {}", where, planes[i], i, planes[i - 1]));
}

// Numbers separated by white space or commas. A comment begins with # and lasts to the end of the line.
std::vector<double> read_planes(const fs::path& path) {
  const std::string text = read_text(path);
  const auto separates = [](char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == ','; };
  std::vector<double> planes;
  int64_t line = 1;
  for (const char *p = text.data(), *end = p + text.size(); p < end;) {
    if (*p == '#') {
      p = std::find(p, end, '\n');
    } else if (separates(*p)) {
      line += *p++ == '\n';
    } else {
      const char* stop = std::find_if(p, end, [&](char c) { return separates(c) || c == '#'; });
      const bool plus = *p == '+' && stop - p > 1 && p[1] != '-';  // from_chars takes no plus sign
      double plane = 0;
      const auto [read, error] = std::from_chars(p + plus, stop, plane);
      if (error != std::errc{} || read != stop || !std::isfinite(plane))
        throw InputError(fmt::format("{}:{}: expected a number, found \"{}\"", path.string(), line, printable({p, std::min<size_t>(stop - p, 60)})));
      planes.push_back(plane + 0.0);  // -0 is 0
      p = stop;
    }
  }
  check_planes(planes, path.string());
  return planes;
}

// ---- grid

constexpr std::pair<const char*, std::optional<double> SceneAxis::*> kAxisNumbers[] = {
    {"min", &SceneAxis::min}, {"max", &SceneAxis::max}, {"step", &SceneAxis::step}};

void refuse_ways_together(const JsonNode& node) {
  std::vector<std::string_view> ways;
  for (const char* key : {"cells", "step", "auto"})
    if (node.find(key)) ways.emplace_back(key);
  if (ways.size() > 1) throw UsageError(fmt::format("{}: {} exclude each other: give one of them", node.where(), fmt::join(ways, " and ")));
}

void parse_axis(const JsonNode& node, const fs::path& folder, SceneAxis& axis) {
  node.check_keys({"planes", "planes_file", "min", "max", "cells", "step", "auto"});
  const std::optional<JsonNode> planes = node.find("planes"), file = node.find("planes_file");
  if (planes || file) {
    std::vector<std::string> others;
    for (const char* key : {"min", "max", "cells", "step", "auto", planes ? "planes_file" : "planes"})
      if (node.find(key)) others.push_back(fmt::format("\"{}\"", key));
    if (!others.empty())
      throw UsageError(fmt::format("{}: \"{}\" says where all cells of an axis are: take away {}", node.where(), planes ? "planes" : "planes_file",
                                   fmt::join(others, ", ")));
    axis = {};
    if (file) {
      axis.planes_file = folder / file->text();
      axis.planes = read_planes(axis.planes_file);
      return;
    }
    for (const JsonNode& plane : planes->items()) axis.planes.push_back(plane.number());
    check_planes(axis.planes, planes->where());
    return;
  }
  refuse_ways_together(node);
  if (const auto n = node.find("min")) axis.min = n->number();
  if (const auto n = node.find("max")) axis.max = n->number();
  if (const auto n = node.find("cells")) axis.cells = n->integer(1, Axis::kMaxCells), axis.step.reset(), axis.made.reset();
  if (const auto n = node.find("step")) axis.step = n->positive(), axis.cells.reset(), axis.made.reset();
  if (const auto n = node.find("auto")) axis.made = parse_auto_of_axis(*n), axis.cells.reset(), axis.step.reset();
}

[[noreturn]] void refuse_pad(const std::string& where) {
  throw UsageError(fmt::format("{}.auto.pad: expected none beside min and max, which say where the domain ends", where));
}

void parse_grid(const JsonNode& grid, const fs::path& folder, Scene& scene) {
  grid.check_keys({"min", "max", "cells", "step", "auto", "pad", "x", "y", "z"});
  refuse_ways_together(grid);
  if (const auto pad = grid.find("pad")) scene.pad = pad->integer(0, kMaxPad);
  for (const auto& [key, member] : kAxisNumbers) {
    const auto node = grid.find(key);
    if (!node) continue;
    const bool is_step = member == &SceneAxis::step, scalar = is_step && !node->is_array();  // one step for all axes
    const std::vector<JsonNode> items = scalar ? std::vector<JsonNode>(3, *node) : node->items(3);
    for (int a = 0; a < 3; ++a) scene.axis[a].*member = is_step ? items[a].positive() : items[a].number();
  }
  if (const auto cells = grid.find("cells")) {
    if (!cells->is_array()) scene.longest_cells = cells->integer(1, Axis::kMaxCells);
    else
      for (int a = 0; a < 3; ++a) scene.axis[a].cells = cells->items(3)[a].integer(1, Axis::kMaxCells);
  }

  if (const auto made = grid.find("auto")) {
    if (grid.find("pad")) throw UsageError(fmt::format("{}: auto and pad exclude each other: \"auto\" has a \"pad\" of its own", grid.where()));
    const std::array<AutoPlanes, 3> of_axis = parse_auto_of_grid(*made);
    for (int a = 0; a < 3; ++a) scene.axis[a].made = of_axis[a];
  }
  const auto pad_of = [](const JsonNode& node) { return node.find("auto") && node.find("auto")->find("pad"); };

  bool longest_used = false;
  for (int a = 0; a < 3; ++a) {
    SceneAxis& axis = scene.axis[a];
    const auto node = grid.find(axis_name(a));
    const bool has_fixed = axis.made && !axis.made->fixed.empty();
    if (node) parse_axis(*node, folder, axis);
    if (has_fixed && !axis.made)
      throw UsageError(
          fmt::format("{0}.auto.fixed.{1}: expected none, as {0}.{1} has planes, cells or a step of its own", grid.where(), axis_name(a)));
    const std::string where = node ? node->where() : fmt::format("{} (axis {})", grid.where(), axis_name(a));
    if (axis.min.has_value() != axis.max.has_value())
      throw UsageError(fmt::format("{}: expected min and max or neither, found only {}", where, axis.min ? "min" : "max"));
    if (axis.min && !(*axis.min < *axis.max)) throw UsageError(fmt::format("{}: expected min < max, found {} and {}", where, *axis.min, *axis.max));
    if (axis.min && node && pad_of(*node)) refuse_pad(node->where());
    longest_used |= axis.planes.empty() && !axis.cells && !axis.step && !axis.made;
  }
  if (!longest_used) scene.longest_cells.reset();
  if (pad_of(grid) && std::ranges::none_of(scene.axis, [](const SceneAxis& axis) { return axis.made && !axis.min; })) refuse_pad(grid.where());
}

// ---- materials and bodies

std::string color_text(const JsonNode& node) {
  std::string color = node.text();
  if (!parse_color(color)) node.fail("a color \"#rrggbb\" or \"#rrggbbaa\"");
  for (char& c : color)
    if (c >= 'A' && c <= 'F') c = static_cast<char>(c - 'A' + 'a');
  return color;
}

// Numbers of materials by name: the background is 0, the others count from 1 in the order of the scene.
using MaterialIds = std::unordered_map<std::string, uint32_t>;

uint32_t material_id(const JsonNode& node, const MaterialIds& ids) {
  const auto it = ids.find(node.text());
  if (it != ids.end()) return it->second;
  std::vector<std::string_view> known;
  for (const auto& [name, id] : ids) known.push_back(name);
  std::sort(known.begin(), known.end());
  node.fail(fmt::format("a material that \"materials\" declares{}",
                        known.empty() ? "" : fmt::format(" (the nearest is \"{}\")", nearest(node.text(), known))));
}

std::string color_in(const JsonNode& material, const std::string& otherwise) {
  material.check_keys({"color"});
  const auto color = material.find("color");
  return color ? color_text(*color) : otherwise;
}

MaterialIds parse_materials(const JsonNode& root, Scene& scene) {
  const std::optional<JsonNode> materials = root.find("materials"), background = root.find("background");
  if (materials && !materials->is_object()) materials->fail("an object of materials");
  const std::string back = background ? background->text() : "air";
  const std::optional<JsonNode> of_back = materials ? materials->find(back) : std::nullopt;
  MaterialIds ids = {{back, 0}};
  scene.materials.push_back({back, of_back ? color_in(*of_back, kBackgroundColor) : kBackgroundColor});
  const std::vector<JsonNode> members = materials ? materials->members() : std::vector<JsonNode>{};
  for (const JsonNode& material : members) {
    const std::string name(material.key());
    if (name.empty() || printable(name) != name)
      throw UsageError(fmt::format("{}: expected a name that is not empty and has no control characters", material.where()));
    if (name.size() > kMostName)
      throw UsageError(
          fmt::format("materials: expected names of at most {} bytes, found \"{}...\" of {}", kMostName, first_bytes(name, 60), name.size()));
    if (name == back) continue;
    const auto id = static_cast<uint32_t>(scene.materials.size());
    if (id > kMaxMaterials)
      throw UsageError(fmt::format("materials: expected at most {} besides the background, found {}", kMaxMaterials, members.size()));
    scene.materials.push_back({name, color_in(material, palette_color(id))});
    ids.emplace(name, id);
  }
  if (back != "air" && !of_back) {  // "air" alone needs no entry
    ids.erase(back);
    material_id(*background, ids);
  }
  return ids;
}

// Whether the matrix would flatten the body: its columns, scaled to unit vectors, span no more volume than rounding errors may leave.
bool is_singular(const Matrix& m) {
  std::array<Vec3, 3> column;
  for (int c = 0; c < 3; ++c) {
    const double length = std::hypot(m[c], m[4 + c], m[8 + c]);
    if (!(length > 0) || !std::isfinite(length)) return true;
    for (int r = 0; r < 3; ++r) column[c][r] = m[4 * r + c] / length;
  }
  const auto& [a, b, c] = column;
  const double det = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
  return !(std::abs(det) > 1e-15);
}

Matrix parse_rotate(const JsonNode& node) {
  node.check_keys({"axis", "degrees"});
  const Vec3 axis = node.require("axis").numbers<3>();
  if (axis == Vec3{0, 0, 0}) node.require("axis").fail("an axis that is not zero");
  return rotation(axis, node.require("degrees").number());
}

Matrix parse_matrix(const JsonNode& body) {
  const auto matrix = body.find("matrix"), scale = body.find("scale"), rotate = body.find("rotate"), translate = body.find("translate");
  Matrix m = kIdentity;
  if (matrix) {
    if (scale || rotate || translate)
      throw UsageError(fmt::format("{}: matrix excludes scale, rotate and translate: give either the matrix or the others", body.where()));
    const std::vector<JsonNode> items = matrix->items(12);
    for (size_t i = 0; i < 12; ++i) m[i] = items[i].number();
    if (is_singular(m)) matrix->fail("a matrix that is not singular");
    return m;
  }
  if (rotate) m = parse_rotate(*rotate);
  if (scale) {
    const Vec3 s = scale->is_array() ? scale->numbers<3>() : Vec3{scale->number(), scale->number(), scale->number()};
    if (s[0] == 0 || s[1] == 0 || s[2] == 0) scale->fail("a scale that is not 0");
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) m[4 * r + c] = m[4 * r + c] * s[c] + 0.0;
    if (is_singular(m)) scale->fail("a scale within the range of doubles");
  }
  if (translate) {
    const Vec3 t = translate->numbers<3>();
    for (int r = 0; r < 3; ++r) m[4 * r + 3] = t[r];
  }
  return m;
}

// "cap", "strict" or {"extrude": "-z"}.
Closing closing_of(const JsonNode& node) {
  if (!node.is_object()) {
    if (node.is_array()) node.fail("\"cap\", \"strict\" or {\"extrude\": \"-z\"}");
    if (node.text() == "cap") return {};
    if (node.text() == "strict") return {Closing::Way::kStrict};
    node.fail("\"cap\", \"strict\" or {\"extrude\": \"-z\"}");
  }
  node.check_keys({"extrude"});
  const JsonNode direction = node.require("extrude");
  const auto closing = parse_closing("extrude:" + direction.text());
  if (!closing) direction.fail("a direction along the grid: \"+x\", \"-x\", \"+y\", \"-y\", \"+z\" or \"-z\"");
  return *closing;
}

SceneBody parse_body(const JsonNode& node, const MaterialIds& ids, const fs::path& folder) {
  node.check_keys({"name", "mesh", "part", "material", "priority", "fill", "closing", "stitch", "kind", "thin", "deflection", "angle", "face_patches",
                   "patches", "matrix", "scale", "rotate", "translate"});
  SceneBody body;
  body.mesh = folder / node.require("mesh").text();
  body.mesh_text = mesh_shown(node.require("mesh").text(), folder);
  body.material = material_id(node.require("material"), ids);
  if (const auto n = node.find("name")) {
    body.name = n->text();
    if (body.name.size() > kMostName) n->fail(fmt::format("a name of at most {} bytes", kMostName));
  }
  if (const auto n = node.find("part")) body.part = n->any_text().empty() ? n->text() : n->any_text();  // a file may have any name
  if (const auto n = node.find("priority")) body.priority = n->integer(INT64_MIN, INT64_MAX);
  if (const auto n = node.find("fill")) body.fill = static_cast<Fill>(n->choice(kFillNames));
  if (const auto n = node.find("closing")) body.closing = closing_of(*n);
  if (const auto n = node.find("stitch")) {
    body.stitch = n->number();
    if (!(*body.stitch >= 0 && *body.stitch <= 1e75)) n->fail("a length from 0 to 1e75");
  }
  if (const auto n = node.find("kind")) body.kind = static_cast<Kind>(n->choice({"solid", "sheet"}));
  if (const auto n = node.find("thin")) body.thin = static_cast<Thin>(n->choice({"ignore", "keep"}));
  if (body.kind == Kind::kSheet && (body.fill != Fill::kAuto || body.closing != Closing{} || body.stitch || body.thin != Thin::kIgnore))
    throw UsageError(fmt::format(
        "{}: fill, closing, stitch and thin are for solids only: a sheet is not filled, closed or stitched, and no part of it is lost between sample points",
        node.where()));
  if (const auto n = node.find("deflection")) {
    if (n->is_string()) {
      const auto parsed = parse_deflection(n->text());
      if (!parsed || !parsed->in_cells) n->fail("a length, or cells such as \"0.1c\"");
      body.deflection = *parsed;
    } else {
      body.deflection = {n->positive(), false};
    }
    if (!(body.deflection.value <= 1e75)) n->fail("a length up to 1e75");
  }
  if (const auto n = node.find("angle")) {
    body.angle = n->number();
    if (!is_chord_angle(body.angle)) n->fail("degrees from 0.1 to 90");
  }
  if (const auto n = node.find("face_patches")) body.face_patches = n->boolean();
  if (const auto n = node.find("patches")) body.patches = n->boolean();
  body.matrix = parse_matrix(node);
  return body;
}

// Bodies without a name get their mesh's, with a number where that name is taken.
void name_bodies(std::vector<SceneBody>& bodies) {
  NameBook names;
  for (size_t i = 0; i < bodies.size(); ++i) {
    const std::string& name = bodies[i].name;
    if (name.empty() || names.take(name)) continue;
    const auto first = std::find_if(bodies.begin(), bodies.end(), [&](const SceneBody& b) { return b.name == name; });
    throw UsageError(fmt::format("bodies[{}].name: expected a name of its own, found \"{}\" as in bodies[{}]", i, name, first - bodies.begin()));
  }
  for (SceneBody& body : bodies)
    if (body.name.empty()) body.name = names.numbered(mesh_stem(body.mesh_text));
}

// What rules for planes say of bodies and materials must be about some of the scene.
void check_names(const Scene& scene, const MaterialIds& ids) {
  std::set<std::string_view> bodies;
  for (const SceneBody& body : scene.bodies) bodies.insert(body.name);
  for (int a = 0; a < 3; ++a) {
    if (!scene.axis[a].made) continue;
    const auto check = [&](const char* key, const std::string& name) {
      if (!bodies.contains(name) && !ids.contains(name))
        throw UsageError(fmt::format("grid: \"{}\" of axis {}: expected the name of a body or a material, found \"{}\"", key, axis_name(a), name));
    };
    const SceneAxis& axis = scene.axis[a];
    for (const double at : axis.made->fixed)
      if (axis.min && !(at >= *axis.min && at <= *axis.max)) refuse_fixed(a, *axis.min, *axis.max, at);
    for (const auto& [name, within] : axis.made->resolution) check("resolution", name);
    for (const std::string& name : axis.made->metals) check("metals", name);
  }
}

// ---- writing

template <typename T, typename Member>
void put_axes(Json& grid, const Scene& scene, const char* key, Member member, bool may_be_array) {
  const auto& axis = scene.axis;
  if (may_be_array && axis[0].*member && axis[1].*member && axis[2].*member) {
    grid[key] = {*(axis[0].*member), *(axis[1].*member), *(axis[2].*member)};
    return;
  }
  for (int a = 0; a < 3; ++a)
    if (axis[a].*member) grid[axis_name(a)][key] = T{*(axis[a].*member)};
}

Json normalised_grid(const Scene& scene) {
  Json grid = Json::object();
  const bool counts_may_be_arrays = !scene.longest_cells;  // else the key "cells" holds that number
  if (scene.longest_cells) grid["cells"] = *scene.longest_cells;
  for (const auto& [key, member] : kAxisNumbers) put_axes<double>(grid, scene, key, member, member != &SceneAxis::step || counts_may_be_arrays);
  put_axes<int64_t>(grid, scene, "cells", &SceneAxis::cells, counts_may_be_arrays);
  for (int a = 0; a < 3; ++a)
    if (!scene.axis[a].planes.empty()) grid[axis_name(a)]["planes"] = scene.axis[a].planes;
  for (int a = 0; a < 3; ++a)
    if (scene.axis[a].made) grid[axis_name(a)]["auto"] = normalised(*scene.axis[a].made, scene.axis[a].min.has_value());
  grid["pad"] = scene.pad;
  return grid;
}

Json normalised_without_bodies(const Scene& scene) {
  Json json;
  json["units"] = scene.units;
  json["grid"] = normalised_grid(scene);
  json["sample"] = scene.sample;
  json["background"] = scene.materials.front().name;
  // operator[] searches all keys each time, which would take seconds for 65,535 materials.
  Json::object_t materials;
  materials.reserve(scene.materials.size());
  for (const SceneMaterial& m : scene.materials) materials.push_back({m.name, {{"color", m.color}}});
  json["materials"] = std::move(materials);
  json["label_by"] = kLabelByNames[static_cast<size_t>(scene.label_by)];
  return json;
}

void write_body(JsonWriter& out, const Scene& scene, const SceneBody& b) {
  out.begin_object().field("name", b.name).field("mesh", b.mesh_text);
  if (!b.part.empty()) out.field("part", b.part);
  out.field("material", scene.materials[b.material].name).field("priority", b.priority).field("fill", fill_name(b.fill));
  if (b.closing.way == Closing::Way::kExtrude)
    out.key("closing").begin_object().field("extrude", (b.closing.up ? "+" : "-") + axis_name(b.closing.axis)).end_object();
  else out.field("closing", b.closing.way == Closing::Way::kStrict ? "strict" : "cap");
  if (b.stitch) out.field("stitch", *b.stitch);
  if (b.kind == Kind::kSheet) out.field("kind", "sheet");
  if (b.thin == Thin::kKeep) out.field("thin", "keep");
  if (b.deflection.in_cells && b.deflection != Deflection{}) out.field("deflection", fmt::format("{}c", b.deflection.value));
  if (!b.deflection.in_cells) out.field("deflection", b.deflection.value);
  if (b.angle != SceneBody{}.angle) out.field("angle", b.angle);
  if (b.face_patches) out.key("face_patches").raw("true");
  if (!b.patches) out.key("patches").raw("false");
  out.field("matrix", b.matrix).end_object();
}

}  // namespace

std::optional<Closing> parse_closing(std::string_view text) {
  using enum Closing::Way;
  if (text == "cap") return Closing{kCap};
  if (text == "strict") return Closing{kStrict};
  constexpr std::string_view kPrefix = "extrude:";
  if (!text.starts_with(kPrefix) || text.size() != kPrefix.size() + 2) return std::nullopt;
  const char sign = text[kPrefix.size()];
  const auto axis = axis_named(text.substr(kPrefix.size() + 1));
  if (!axis || (sign != '+' && sign != '-')) return std::nullopt;
  return Closing{kExtrude, *axis, sign == '+'};
}

std::optional<Deflection> parse_deflection(std::string_view text) {
  Deflection out;
  out.in_cells = text.ends_with('c');
  if (out.in_cells) text.remove_suffix(1);
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), out.value);
  if (error != std::errc{} || stop != text.data() + text.size() || !(out.value > 0 && out.value <= 1e75)) return std::nullopt;
  return out;
}

// What people write for each other.
void drop_notes(Json& node) {
  if (!node.is_structured()) return;
  if (node.is_object())
    if (const auto note = node.find("note"); note != node.end() && note->is_string()) node.erase(note);
  for (Json& child : node) drop_notes(child);
}

Scene parse_scene(const std::string& json_text, const fs::path& folder) try {
  Json text = parse_json(json_text, "", ~size_t{0});
  drop_notes(text);
  const JsonNode root(text, "the scene");
  root.check_keys({"units", "grid", "sample", "background", "materials", "bodies", "label_by"});

  Scene scene;
  if (const auto units = root.find("units")) {
    units->choice({"m", "cm", "mm", "um", "nm", "in", "ft"});
    scene.units = units->text();
  }
  if (const auto grid = root.find("grid")) parse_grid(*grid, folder, scene);
  if (const auto sample = root.find("sample")) {
    scene.sample = sample->numbers<3>();
    for (const JsonNode& s : sample->items())
      if (!(s.number() >= 0 && s.number() < 1)) s.fail("a number from 0 to below 1");
  }
  if (const auto label = root.find("label_by")) scene.label_by = static_cast<LabelBy>(label->choice(kLabelByNames));
  const MaterialIds ids = parse_materials(root, scene);
  const JsonNode bodies = root.require("bodies");
  const std::vector<JsonNode> items = bodies.items();
  scene.bodies.reserve(items.size());
  for (const JsonNode& body : items) scene.bodies.push_back(parse_body(body, ids, folder));
  name_bodies(scene.bodies);
  check_names(scene, ids);
  return scene;
} catch (const FormatError& e) {
  throw UsageError(e.what());
}

Scene read_scene(const fs::path& path) {
  const std::string text = read_text(path);
  try {
    return parse_scene(text, path.parent_path());
  } catch (const UsageError& e) {
    throw UsageError(fmt::format("{}: {}", path.string(), e.what()));
  }
}

std::string normalised(const Scene& scene, size_t most) {
  std::string text = ascii_json(normalised_without_bodies(scene));
  text.back() = ',';
  text += "\"bodies\":";
  const size_t left_out =
      write_list(text, scene.bodies.size(), most, [&](JsonWriter& writer, size_t b) { write_body(writer, scene, scene.bodies[b]); });
  if (left_out > 0) text += fmt::format(",\"bodies_left_out\":{}", left_out);
  return text += '}';
}

}  // namespace teracell::mesher
