#include "mesher/scene/from_parts.hpp"

#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "mesher/scene/names.hpp"
#include "mesher/surface/input.hpp"
#include "mesher/surface/part_path.hpp"
#include "mesher/surface/read_facets.hpp"
#include "store/base/error.hpp"
#include "store/grid/metadata.hpp"
#include "store/text/color.hpp"
#include "store/text/json_text.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

// A part of a file as a scene needs it.
struct Leaf {
  std::string path;  // empty: the whole file, whose only part has no name
  std::string color, material;
};

std::vector<Leaf> leaves_of(const std::filesystem::path& file, const Budget& budget, const CadOptions& cad) {
  std::vector<Leaf> out;
  Input input(file);
  KeptTree kept;
  if (kept.open(input, {.budget = budget, .cad = std::make_shared<const CadOptions>(cad), .outline = true})) {
    for (const Part& part : kept.tree->parts()) out.push_back({part.path, kept.tree->node(part).color, kept.tree->node(part).material});
    if (out.empty()) refuse_empty(file.string(), kept.file);
    return out;
  }
  const SurfaceFile found = read_facets(input, "", [](std::span<const Facet>) {}, {.budget = budget});
  for (const std::string& name : found.patches)
    out.push_back({name.empty() && found.patches.size() == 1 ? "" : path_below("", name.empty() ? kUnnamedPart : name), "", ""});
  return out;
}

std::string body_name(const Leaf& leaf, const std::filesystem::path& file, NameBook& names) {
  return names.numbered(leaf.path.empty() ? mesh_stem(file) : printable(first_bytes(utf8_of(leaf.path), kMostStem)));
}

// "nut" for "/as1/nut#2".
std::string plain_name(const std::string& path) {
  const std::vector<std::string> names = names_of(path);
  return names.empty() ? "" : std::string(without_number(names.back()));
}

// The materials of a scene: those that files name, else one for each colour, else one for each name of parts.
class Materials {
 public:
  Materials() { names_.take("air"); }
  const std::string& of(const Leaf& leaf, const std::string& body) {
    const std::string named = printable(first_bytes(leaf.material, kMostStem));
    const std::string key = !named.empty() ? "m" + named : !leaf.color.empty() ? "c" + leaf.color : "n" + plain_name(leaf.path);
    const auto [known, fresh] = by_key_.try_emplace(key, list_.size());
    if (fresh) {
      const std::string stem = !named.empty() ? named : !leaf.color.empty() ? leaf.color : printable(first_bytes(plain_name(leaf.path), kMostStem));
      std::string name = names_.numbered(stem.empty() ? body : stem);
      const char* guess = !named.empty()        ? ""
                          : !leaf.color.empty() ? "guessed: the file states this colour and no material"
                                                : "guessed: named after the parts";
      list_.push_back({std::move(name), leaf.color.empty() ? palette_color(static_cast<uint32_t>(list_.size() + 1)) : leaf.color, guess});
    }
    return list_[known->second].name;
  }
  struct Material {
    std::string name, color, guess;
  };
  const std::vector<Material>& list() const { return list_; }

 private:
  NameBook names_;
  std::unordered_map<std::string, size_t> by_key_;
  std::vector<Material> list_;
};

std::string quoted(const std::string& text) { return Json(utf8_of(text)).dump(); }

}  // namespace

Scene scene_by_part(const std::vector<std::filesystem::path>& files, const Budget& budget, const CadOptions& cad) {
  Scene scene;
  scene.materials.push_back({"air", kBackgroundColor});
  NameBook names;
  names.take("air");
  for (const std::filesystem::path& file : files)
    for (const Leaf& leaf : leaves_of(file, budget, cad)) {
      const auto id = static_cast<uint32_t>(scene.materials.size());
      if (id > kMaxMaterials)
        throw UsageError(
            fmt::format("--by-part: expected at most {} parts, each with a material of its own, found more: `teracell scene` writes a "
                        "scene in which they share materials",
                        kMaxMaterials));
      SceneBody body;
      body.name = body_name(leaf, file, names);
      body.mesh = file;
      body.mesh_text = bare_mesh_shown(file);
      body.part = leaf.path;
      body.material = id;
      scene.materials.push_back({body.name, leaf.color.empty() ? palette_color(id) : leaf.color});
      scene.bodies.push_back(std::move(body));
    }
  return scene;
}

SceneText scene_text(const std::vector<std::filesystem::path>& files, const std::filesystem::path& folder, std::optional<int64_t> cells,
                     std::optional<double> step, const std::string& units, const Budget& budget, const CadOptions& cad) {
  SceneText out;
  NameBook names;
  Materials materials;
  std::string bodies;
  for (const std::filesystem::path& file : files) {
    const std::string mesh = std::filesystem::proximate(file, folder.empty() ? "." : folder).string();
    for (const Leaf& leaf : leaves_of(file, budget, cad)) {
      const std::string name = body_name(leaf, file, names);
      bodies += fmt::format("{}    {{\"name\": {}, \"mesh\": {}, {}\"material\": {}}}", out.bodies++ > 0 ? ",\n" : "", quoted(name), quoted(mesh),
                            leaf.path.empty() ? "" : fmt::format("\"part\": {}, ", quoted(leaf.path)), quoted(materials.of(leaf, name)));
    }
  }
  std::string list;
  for (const auto& m : materials.list()) {
    list += fmt::format(",\n    {}: {{\"color\": \"{}\"{}}}", quoted(m.name), m.color,
                        m.guess.empty() ? "" : fmt::format(", \"note\": {}", quoted(m.guess)));
    if (!m.guess.empty()) out.guessed.push_back(m.name);
  }
  out.materials = materials.list().size();
  out.text = fmt::format(
      "{{\n  \"note\": \"Later bodies win where bodies overlap, unless they have a priority. Cells are cubes; \\\"cells\\\" counts those of the longest "
      "axis.\",\n  \"units\": \"{}\",\n  \"grid\": {{{}, \"pad\": 1}},\n  \"background\": \"air\",\n  \"label_by\": \"body\",\n  \"materials\": {{\n    \"air\": {{\"color\": \"{}\"}}{}\n  }},\n"
      "  \"bodies\": [\n{}\n  ]\n}}\n",
      units.empty() ? first_stated_unit(files) : units,
      step ? fmt::format("\"step\": {}", Json(*step).dump()) : fmt::format("\"cells\": {}", cells.value_or(200)), kBackgroundColor, list, bodies);
  return out;
}

}  // namespace teracell::mesher
