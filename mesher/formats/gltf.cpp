// glTF 2.0 and GLB: the tree of the default scene. A mesh with all its primitives is a part; its triangles, strips and fans become facets.
// Points and lines are left out, and so is what moves vertices over time (skins, morph targets): shapes are as they are stored.
#include <unordered_map>
#include <utility>

#include <fmt/format.h>

#include "mesher/formats/gltf_file.hpp"
#include "mesher/surface/readers.hpp"
#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

enum Mode : uint32_t { kTriangles = 4, kStrip = 5, kFan = 6 };

class Reader {
 public:
  Reader(Input& input, SurfaceFile& file, const ReadOptions& options) : gltf_(input, file, options.budget), file_(file), shapes_(options.budget) {
    file.unit = "m";
    file.factor = factor(file.unit, options.units);
  }

  PartTree tree() {
    const std::vector<uint32_t> at_root = gltf_.roots();
    given_ = gltf_.take_nodes();
    std::vector<PartNode> nodes(given_.size());
    std::vector<uint32_t> parents(nodes.size()), next;  // of the nodes that the scene has; others may be broken
    std::vector<PartNode::Use> roots;
    const auto use_of = [&](uint32_t node, const std::string& where) {
      PartNode::Use made = use(node, where, parents);
      next.push_back(node);
      return made;
    };
    roots.reserve(at_root.size());
    for (const uint32_t root : at_root) roots.push_back(use_of(root, "scenes"));
    while (!next.empty()) {
      const uint32_t i = next.back();
      next.pop_back();
      GltfNode& n = given_[i];
      const std::string where = fmt::format("nodes[{}]", i);
      PartNode& node = nodes[i];
      node.name = std::move(n.name);
      if (n.mesh) take_mesh(*n.mesh, node, where);
      if (node.name.empty()) node.name = node.product.empty() ? fmt::format("node {}", i) : node.product;
      for (const uint32_t child : n.children) node.uses.push_back(use_of(child, where));
    }
    if (left_out_ > 0)
      file_.warnings.push_back(fmt::format("{} of points and lines {} left out", plural(left_out_, "primitive"), left_out_ == 1 ? "was" : "were"));
    given_ = {};
    return PartTree(gltf_.name(), std::move(shapes_), std::move(nodes), roots);
  }

 private:
  // A node has one parent, so there is no circle that the roots lead to.
  PartNode::Use use(uint32_t node, const std::string& where, std::vector<uint32_t>& parents) {
    if (node >= parents.size()) refuse(fmt::format("{}: expected the number of a node, found {} of {}", where, node, parents.size()));
    if (++parents[node] > 1) refuse(fmt::format("{}: expected a tree, in which a node has one parent; node {} has several", where, node));
    Matrix m = given_[node].matrix;
    for (size_t row = 0; row < 3; ++row) m[4 * row + 3] = file_.factor.of(checked_coordinate(m[4 * row + 3], gltf_.name()));
    return {node, m, ""};
  }

  void take_mesh(uint32_t number, PartNode& node, const std::string& where) {
    if (number >= gltf_.meshes().size())
      refuse(fmt::format("{}: expected the number of a mesh, found {} of {}", where, number, gltf_.meshes().size()));
    const GltfMesh& mesh = gltf_.meshes()[number];
    auto [known, fresh] = shape_of_.try_emplace(number, 0);
    if (fresh) known->second = make_shape(mesh, number);
    node.shape = known->second;
    node.product = mesh.name;
    if (mesh.primitives.empty()) return;
    const auto material = mesh.primitives[0].material;  // that of all, or none
    for (const GltfPrimitive& p : mesh.primitives)
      if (p.material != material) return;
    if (material && *material < gltf_.materials().size())
      node.material = gltf_.materials()[*material].name, node.color = gltf_.materials()[*material].color;
  }

  uint32_t make_shape(const GltfMesh& mesh, uint32_t number) {
    for (const GltfPrimitive& p : mesh.primitives) vertices_of(p.positions);
    const uint32_t shape = shapes_.begin_shape();
    for (const GltfPrimitive& p : mesh.primitives) {
      if (p.mode < kTriangles) ++left_out_;
      else if (p.mode > kFan) refuse(fmt::format("meshes[{}]: expected a mode of 0 to 6, found {}", number, p.mode));
      else add_primitive(p, number);
    }
    return shape;
  }

  uint32_t vertices_of(uint32_t accessor) {
    const auto [known, fresh] = sets_.try_emplace(accessor, 0);
    if (!fresh) return known->second;
    known->second = shapes_.begin_vertices(gltf_.is_float(accessor));
    gltf_.read_vectors(accessor, [&](const Vec3& v) { shapes_.add_vertex(v, file_.factor, gltf_.name()); });
    return known->second;
  }

  void add_primitive(const GltfPrimitive& p, uint32_t mesh) {
    const uint32_t set = vertices_of(p.positions);
    const uint64_t vertices = shapes_.vertices(set);
    std::array<uint32_t, 3> last{};
    uint64_t taken = 0;
    const auto take = [&](uint64_t vertex) {
      if (vertex >= vertices) refuse(fmt::format("meshes[{}]: expected the number of a vertex below {}, found {}", mesh, vertices, vertex));
      const auto v = static_cast<uint32_t>(vertex);
      if (p.mode == kFan) {
        if (taken >= 2) shapes_.add_triangle(set, {last[1], v, last[0]});
        last[taken == 0 ? 0 : 1] = v;
      } else if (p.mode == kStrip) {
        if (taken >= 2) shapes_.add_triangle(set, taken % 2 == 0 ? std::array{last[0], last[1], v} : std::array{last[1], last[0], v});
        if (taken >= 2) last[0] = last[1], last[1] = v;
        else last[taken] = v;
      } else {
        last[taken % 3] = v;
        if (taken % 3 == 2) shapes_.add_triangle(set, last);
      }
      ++taken;
    };
    if (p.indices) return gltf_.read_scalars(*p.indices, take);
    gltf_.spend(vertices * sizeof(uint32_t), fmt::format("meshes[{}]", mesh));
    for (uint64_t i = 0; i < vertices; ++i) take(i);
  }

  [[noreturn]] void refuse(const std::string& why) const { throw InputError(fmt::format("{}: {}", gltf_.name(), why)); }

  GltfFile gltf_;
  std::vector<GltfNode> given_;  // the file's nodes, while they become parts
  SurfaceFile& file_;
  Shapes shapes_;
  std::unordered_map<uint32_t, uint32_t> shape_of_, sets_;  // by the number of a mesh; of an accessor
  uint64_t left_out_ = 0;
};

Match recognises_gltf(const Head& head) {
  if (head.bytes.starts_with("glTF")) return Match::kSure;
  if (!head.text || !head.word.starts_with('{')) return Match::kNo;
  const auto has = [&](std::string_view key) { return head.bytes.find(key) != std::string_view::npos; };
  const bool lists = has("\"asset\"") || has("\"accessors\"") || has("\"bufferViews\"");  // the keys may come in any order
  return lists && !has("\"bodies\"") ? Match::kSure : Match::kNo;
}

PartTree open_gltf(Input& input, SurfaceFile& file, const ReadOptions& options) { return Reader(input, file, options).tree(); }

}  // namespace

const SurfaceReader kGltfReader = {"glTF", recognises_gltf, nullptr, open_gltf, [](Input&) { return std::string("m"); }};

}  // namespace teracell::mesher
