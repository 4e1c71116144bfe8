// 3MF: a ZIP package with a model in XML. Its objects are meshes, or components that place other objects; its items place objects in the
// build. "3D Manufacturing Format, Core Specification", 3MF Consortium, 1.3. What a file can't be read without, it lists as required
// extensions: those that change no shape (materials, sets of triangles) are passed over, others are refused by their names.
//
// The model passes as a stream, so memory holds the objects, their uses and, up to the budget, vertices and triangles. (Rejected: lib3mf. It
// holds a whole model in memory, several hundred bytes per triangle, and its versions 1 and 2 have different interfaces.)
#include <algorithm>
#include <optional>
#include <unordered_map>

#include <fmt/format.h>

#include "mesher/formats/xml.hpp"
#include "mesher/formats/zip_package.hpp"
#include "mesher/surface/readers.hpp"
#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

using namespace std::string_view_literals;

constexpr std::string_view kSchemas = "http://schemas.microsoft.com/3dmanufacturing/";
constexpr std::string_view kProductionPath = "http://schemas.microsoft.com/3dmanufacturing/production/2015/06|path";
// Each is held in memory, a hundred bytes or more.
constexpr size_t kMostObjects = size_t{1} << 18, kMostUses = size_t{1} << 19, kMostMaterials = size_t{1} << 16;

struct UnitName {
  std::string_view in_file, unit;
};
constexpr UnitName kModelUnits[] = {{"micron", "um"}, {"millimeter", "mm"}, {"centimeter", "cm"}, {"inch", "in"}, {"foot", "ft"}, {"meter", "m"}};

std::string name_of(const char* text) { return text ? std::string(first_bytes(utf8_of(text), kLongestPartName)) : ""; }

// "/3D/3dmodel.model", the model that the package's relationships name.
std::string model_of(const ZipPackage& package) {
  constexpr const char* kRelationships = "_rels/.rels";
  std::vector<std::string> targets;
  XmlReader xml(
      fmt::format("{}: '{}'", package.name(), kRelationships),
      [&](const XmlElement& e) {
        const char *type = e.find("Type"), *target = e.find("Target");
        if (e.name().ends_with("|Relationship") && type && target &&
            std::string_view(type) == "http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel" && targets.size() < 2)
          targets.emplace_back(target);
      },
      [](std::string_view) {});
  package.read(kRelationships, [&](std::string_view text) { return xml.feed(text), true; });
  xml.finish();
  if (targets.size() != 1)
    throw InputError(fmt::format("{}: '{}': expected one relationship to a 3D model, found {}", package.name(), kRelationships,
                                 targets.empty() ? "none" : fmt::format("{} and {}", shown(targets[0]), shown(targets[1]))));
  std::string model = targets[0].substr(targets[0].starts_with('/') ? 1 : 0);
  if (!package.has(model))
    throw InputError(
        fmt::format("{}: '{}': expected the 3D model {} in the package, found no such file", package.name(), kRelationships, shown(targets[0])));
  return model;
}

// The unit of a <model>.
std::string unit_of(const XmlElement& model, const XmlReader& xml) {
  const char* unit = model.find("unit");
  const auto* known = std::ranges::find(kModelUnits, std::string_view(unit ? unit : "millimeter"), &UnitName::in_file);
  if (known == std::end(kModelUnits))
    throw InputError(fmt::format("{}: expected the unit micron, millimeter, centimeter, inch, foot or meter, found {}", xml.at_line(), shown(unit)));
  return std::string(known->unit);
}

class ModelReader {
 public:
  ModelReader(const ZipPackage& package, const std::string& model, SurfaceFile& file, const ReadOptions& options)
      : file_(file),
        options_(options),
        name_(package.name()),
        shapes_(options.budget),
        xml_(
            fmt::format("{}: {}", package.name(), shown(model)), [this](const XmlElement& e) { begin(e); },
            [this](std::string_view name) { end(name); }) {
    package.read(model, [&](std::string_view text) { return xml_.feed(text), true; });
    xml_.finish();
  }

  PartTree tree() {
    if (file_.unit.empty()) refuse("expected a <model> of 3MF, found none");
    std::vector<PartNode> nodes;
    for (Object& o : objects_) nodes.push_back(node_of(o));
    std::vector<PartNode::Use> roots;
    for (const Use& use : items_)
      if (const uint32_t object = number_of(use); is_of_model(object)) roots.push_back({object, use.matrix, ""});
    if (helpers_ > 0)
      file_.warnings.push_back(fmt::format(
          "{} left out: objects of the types support, solidsupport and other help printing and are no part of the model", plural(helpers_, "place")));
    if (items_.empty() && !objects_.empty())
      file_.warnings.push_back(fmt::format("<build> has no item, so none of the {} stands anywhere", plural(objects_.size(), "object")));
    return PartTree(name_, std::move(shapes_), std::move(nodes), roots);
  }

 private:
  struct Use {
    uint32_t id;
    Matrix matrix;
    uint64_t line;
  };
  struct Object {
    uint32_t id;
    std::string type, name;
    std::optional<uint32_t> shape, material_group;
    uint32_t material = 0;
    std::vector<Use> components;
  };
  struct Material {
    std::string name, color;
  };

  void begin(const XmlElement& e) {
    const size_t bar = e.name().find('|');
    if (bar == std::string_view::npos) return;
    const std::string_view name = e.name().substr(bar + 1);
    if (!e.name().starts_with(kSchemas)) return;
    if (e.name().substr(kSchemas.size()).starts_with("material/")) return begin_material(name, e);
    if (!e.name().substr(kSchemas.size()).starts_with("core/")) return;
    if (name == "vertex") add_vertex(e);
    else if (name == "triangle") add_triangle(e);
    else if (name == "model") begin_model(e);
    else if (name == "object") begin_object(e);
    else if (name == "mesh") begin_mesh();
    else if (name == "component") add_component(e);
    else if (name == "item") add_item(e);
    else begin_material(name, e);
  }

  void end(std::string_view name) {
    if (name.ends_with("|object")) in_object_ = in_mesh_ = false;
    else if (name.ends_with("|mesh")) in_mesh_ = false;
  }

  void begin_model(const XmlElement& e) {
    file_.unit = unit_of(e, xml_);
    file_.factor = factor(file_.unit, options_.units);
    const char* required = e.find("requiredextensions");
    std::string_view prefixes = required ? required : "";
    for (std::string_view prefix; !(prefix = next_word(prefixes)).empty();) {
      const std::string uri = xml_.name_space(std::string(prefix));
      const bool of_looks = uri.starts_with(kSchemas) &&
                            (uri.substr(kSchemas.size()).starts_with("material/") || uri.substr(kSchemas.size()).starts_with("trianglesets/"));
      if (!of_looks)
        refuse(fmt::format("the file can't be read without an extension of 3MF, {} ({}): export it without this extension", shown(prefix),
                           uri.empty() ? "no namespace" : printable(first_bytes(utf8_of(uri), kLongestPartName))));
    }
  }

  void begin_object(const XmlElement& e) {
    if (objects_.size() == kMostObjects) refuse(fmt::format("expected at most {} objects, found more", kMostObjects));
    Object o{
        .id = number(e, "id"), .type = name_of(e.find("type")), .name = name_of(e.find("name")), .shape = {}, .material_group = {}, .components = {}};
    if (!by_id_.emplace(o.id, objects_.size()).second) refuse(fmt::format("expected objects with different ids, found {} again", o.id));
    if (e.find("pid")) o.material_group = number(e, "pid");
    if (e.find("pindex")) o.material = number(e, "pindex");
    objects_.push_back(std::move(o));
    in_object_ = true;
  }

  void begin_mesh() {
    if (!in_object_) refuse("expected <mesh> in an object");
    if (objects_.back().shape) refuse(fmt::format("expected one mesh in object {}, found another", objects_.back().id));
    objects_.back().shape = shapes_.begin_shape();
    set_ = shapes_.begin_vertices(false);
    in_mesh_ = true;
  }

  void add_vertex(const XmlElement& e) {
    if (!in_mesh_) refuse("expected <vertex> in a mesh");
    shapes_.add_vertex({coordinate(e, "x"), coordinate(e, "y"), coordinate(e, "z")}, file_.factor, name_);
  }

  void add_triangle(const XmlElement& e) {
    if (!in_mesh_) refuse("expected <triangle> in a mesh");
    std::array<uint32_t, 3> numbers;
    constexpr std::array kNames = {"v1", "v2", "v3"};
    for (size_t i = 0; i < 3; ++i) {
      numbers[i] = number(e, kNames[i]);
      if (numbers[i] >= shapes_.vertices(set_))
        refuse(fmt::format("object {}: expected the number of a vertex, 0 to {}, found {}", objects_.back().id,
                           static_cast<int64_t>(shapes_.vertices(set_)) - 1, numbers[i]));
    }
    shapes_.add_triangle(set_, numbers);
  }

  void add_component(const XmlElement& e) {
    if (!in_object_) refuse("expected <component> in an object");
    objects_.back().components.push_back(use(e));
  }
  void add_item(const XmlElement& e) { items_.push_back(use(e)); }

  Use use(const XmlElement& e) {
    if (++uses_ > kMostUses) refuse(fmt::format("expected at most {} items and components, found more", kMostUses));
    if (e.find(kProductionPath))
      refuse("an object in another file of the package: that is the production extension of 3MF: export the file without it");
    Use out{number(e, "objectid"), kIdentity, xml_.line()};
    if (const char* text = e.find("transform")) out.matrix = matrix(text);
    return out;
  }

  // Rows are what x, y, z and 1 of a vertex are multiplied with.
  Matrix matrix(std::string_view text) {
    Matrix m;
    for (size_t i = 0; i < 12; ++i) {
      const std::string_view word = next_word(text);
      const double v = real(word, "transform");
      m[4 * (i % 3) + i / 3] = i < 9 ? v : file_.factor.of(v);
    }
    if (!next_word(text).empty()) refuse("expected 12 numbers in a transform, found more");
    return m;
  }

  // Groups of materials have an id, and what is in them is known by its place.
  void begin_material(std::string_view name, const XmlElement& e) {
    const bool group = name == "basematerials" || name == "colorgroup";
    if (!group && name != "base" && name != "color") return;
    if (++materials_ > kMostMaterials) refuse(fmt::format("expected at most {} materials, found more", kMostMaterials));
    if (group) group_ = &groups_[number(e, "id")];
    else if (group_) {
      const char* color = e.find(name == "base" ? "displaycolor" : "color");
      group_->push_back({name_of(e.find("name")), color_of(color ? color : "")});
    }
  }

  // "#rrggbb" or "#rrggbbaa"; empty for what is no colour.
  static std::string color_of(std::string_view text) {
    if ((text.size() != 7 && text.size() != 9) || text[0] != '#') return "";
    std::string out(text);
    for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return out.find_first_not_of("0123456789abcdef", 1) == std::string::npos ? out : "";
  }

  // Counts a place of one that is not.
  bool is_of_model(uint32_t object) {
    const std::string& type = objects_[object].type;
    const bool helps = type == "support" || type == "solidsupport" || type == "other";
    helpers_ += helps;
    return !helps;
  }

  PartNode node_of(const Object& o) {
    PartNode node{.name = o.name.empty() ? fmt::format("object {}", o.id) : o.name,
                  .product = o.name,
                  .color = {},
                  .material = {},
                  .shape = o.shape,
                  .uses = {}};
    if (o.material_group)
      if (const auto group = groups_.find(*o.material_group); group != groups_.end() && o.material < group->second.size())
        node.color = group->second[o.material].color, node.material = group->second[o.material].name;
    for (const Use& c : o.components)
      if (const uint32_t object = number_of(c); is_of_model(object)) node.uses.push_back({object, c.matrix, ""});
    return node;
  }

  uint32_t number_of(const Use& use) const {
    const auto found = by_id_.find(use.id);
    if (found == by_id_.end())
      throw InputError(fmt::format("{}: line {} of the model: expected the id of an object, found {}, which no object has", name_, use.line, use.id));
    return static_cast<uint32_t>(found->second);
  }

  uint32_t number(const XmlElement& e, const char* attribute) const {
    const char* text = e.find(attribute);
    uint32_t out = 0;
    const std::string_view word = trimmed(text ? text : "");
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), out);
    if (error != std::errc{} || stop != word.data() + word.size())
      refuse(fmt::format("{}: expected a whole number from 0 on, found {}", attribute, text ? shown(text) : "none"));
    return out;
  }

  double real(std::string_view word, const char* what) const {
    const std::string_view digits = without_plus(word);
    double out = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), out);
    if (error == std::errc::result_out_of_range) out = round_extreme(digits, out);
    if (digits.empty() || stop != digits.data() + digits.size() || error == std::errc::invalid_argument || !is_coordinate(out))
      refuse(
          fmt::format("{}: expected a number that is 0 or has a magnitude from 1e-75 to 1e75, found {}", what, word.empty() ? "none" : shown(word)));
    return out + 0.0;  // -0 is +0
  }
  double coordinate(const XmlElement& e, const char* attribute) const {
    const char* text = e.find(attribute);
    return real(trimmed(text ? text : ""), attribute);
  }

  [[noreturn]] void refuse(const std::string& why) const { throw InputError(fmt::format("{}: {}", xml_.at_line(), why)); }

  SurfaceFile& file_;
  const ReadOptions& options_;
  const std::string name_;
  Shapes shapes_;
  std::vector<Object> objects_;
  std::unordered_map<uint32_t, size_t> by_id_;
  std::unordered_map<uint32_t, std::vector<Material>> groups_;
  std::vector<Material>* group_ = nullptr;
  std::vector<Use> items_;
  size_t uses_ = 0, materials_ = 0;
  uint64_t helpers_ = 0;
  bool in_object_ = false, in_mesh_ = false;
  uint32_t set_ = 0;  // of the mesh's vertices
  XmlReader xml_;     // last: it reads while it is constructed
};

// A package is listed at its end, so its first bytes only show that it is one.
Match recognises_3mf(const Head& head) {
  if (!head.bytes.starts_with("PK\x03\x04")) return Match::kNo;
  const auto has = [&](std::string_view name) { return head.bytes.find(name) != std::string_view::npos; };
  return has("3D/") || has("3d/") || has("_rels/.rels") || has("[Content_Types].xml") ? Match::kSure : Match::kNo;
}

PartTree open_3mf(Input& input, SurfaceFile& file, const ReadOptions& options) {
  file.format = "3MF";
  const Contents contents(input, options.budget);
  const ZipPackage package(input.name(), contents);
  return ModelReader(package, model_of(package), file, options).tree();
}

std::string unit_of_3mf(Input& input) {
  const Contents contents(input, modest_budget());
  const ZipPackage package(input.name(), contents);
  std::string unit;
  const std::string model = model_of(package);
  XmlReader xml(
      fmt::format("{}: {}", package.name(), shown(model)),
      [&](const XmlElement& e) {
        if (unit.empty() && e.name().ends_with("|model")) unit = unit_of(e, xml);
      },
      [](std::string_view) {});
  package.read(model, [&](std::string_view text) { return xml.feed(text), unit.empty(); });
  return unit;
}

}  // namespace

const SurfaceReader kThreeMfReader = {"3MF", recognises_3mf, nullptr, open_3mf, unit_of_3mf};

}  // namespace teracell::mesher
