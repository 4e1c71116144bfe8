#include "mesher/surface/part_tree.hpp"

#include <utility>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

// A file of some kilobytes can describe a tree of any size, because nodes may be used more than once.
constexpr size_t kMostParts = size_t{1} << 18, kMostVisited = 4 * kMostParts, kDeepestTree = 512;
constexpr uint64_t kMostPathBytes = uint64_t{1} << 24;

}  // namespace

uint32_t Shapes::begin_vertices(bool float32) {
  sets_.push_back({vertices_.size(), float32});
  return static_cast<uint32_t>(sets_.size() - 1);
}

void Shapes::add_vertex(const Vec3& v, const Factor& by, const std::string& where) {
  if (by.is_one()) return add_vertex(v);
  Vec3 out;
  for (size_t d = 0; d < 3; ++d) {
    out[d] = by.of(v[d]);
    if (!is_coordinate(out[d])) checked_coordinate(out[d], where + ": a vertex in the units of the scene");
  }
  add_vertex(out);
}

uint32_t Shapes::begin_shape(bool stands_for_facets) {
  shapes_.emplace_back().stands_for_facets = stands_for_facets;
  return static_cast<uint32_t>(shapes_.size() - 1);
}

void Shapes::add_triangle(uint32_t set, const std::array<uint32_t, 3>& numbers) {
  Shape& shape = shapes_.back();
  if (shape.stretches.empty() || shape.stretches.back().set != set) {
    shape.stretches.push_back({set, triangles_.size(), 0});
    shape.float32 = shape.float32 && sets_[set].float32;
  }
  ++shape.stretches.back().count;
  if (!shape.groups.empty()) ++shape.groups.back().facets;
  ++shape.facets;
  triangles_.push_back(numbers);
}

PartTree::PartTree(std::string name, Shapes&& shapes, std::vector<PartNode>&& nodes, const std::vector<PartNode::Use>& roots)
    : name_(std::move(name)), shapes_(std::move(shapes)), nodes_(std::move(nodes)) {
  visit(roots, "", kIdentity, 1);
}

void PartTree::visit(const std::vector<PartNode::Use>& uses, const std::string& above, const Matrix& matrix, size_t depth) {
  if (uses.empty()) return;
  if (depth > kDeepestTree)
    throw InputError(fmt::format("{}: {}: expected at most {} levels in the tree of parts, found more: does a part contain itself?", name_,
                                 shown(above), kDeepestTree));
  const auto name_of = [&](const PartNode::Use& use) -> const std::string& { return use.name.empty() ? nodes_[use.node].name : use.name; };
  visited_ += uses.size();
  for (const PartNode::Use& use : uses) name_bytes_ += name_of(use).size();
  if (visited_ > kMostVisited || name_bytes_ > kMostPathBytes)
    throw InputError(fmt::format("{}: expected at most {} places in the tree of parts, with {} bytes of names, found more at {}", name_, kMostVisited,
                                 kMostPathBytes, shown(above.empty() ? "/" : above)));
  std::vector<std::string> names;
  names.reserve(uses.size());
  for (const PartNode::Use& use : uses) names.push_back(name_of(use));
  names = told_apart(std::move(names));
  for (size_t i = 0; i < uses.size(); ++i) {
    const PartNode& node = nodes_[uses[i].node];
    const std::string path = path_below(above, names[i]);
    const Matrix placed = uses[i].matrix == kIdentity ? matrix : matrix == kIdentity ? uses[i].matrix : product(matrix, uses[i].matrix);
    if (node.shape && shapes_.is_part(*node.shape)) {
      path_bytes_ += path.size();
      if (parts_.size() == kMostParts || path_bytes_ > kMostPathBytes)
        throw InputError(fmt::format("{}: expected at most {} parts with {} bytes of names along their paths, found more, the first of them at {}",
                                     name_, kMostParts, kMostPathBytes, shown(path)));
      parts_.push_back({path, uses[i].node, placed});
      facets_ += shapes_.facets(*node.shape);
    }
    visit(node.uses, path, placed, depth + 1);
  }
}

std::vector<uint32_t> PartTree::matching(const PartGlob& glob) {
  std::vector<uint32_t> out;
  if (glob.is_path()) {
    if (by_path_.empty())
      for (uint32_t i = 0; i < parts_.size(); ++i) by_path_.emplace(parts_[i].path, i);
    if (const auto found = by_path_.find(glob.text()); found != by_path_.end()) return {found->second};
  }
  for (uint32_t i = 0; i < parts_.size(); ++i)
    if (glob.matches(parts_[i].path)) out.push_back(i);
  return out;
}

// Null for a shape that is too large to have its vertices listed.
const std::vector<Vec3>* PartTree::corners_of(const Part& part) {
  constexpr uint64_t kMostFacets = uint64_t{1} << 16, kMostCorners = uint64_t{1} << 20;  // all lists take some 24 MB
  const uint32_t shape = *node(part).shape;
  if (const auto known = corners_.find(shape); known != corners_.end()) return &known->second;
  if (facets(part) > kMostFacets || all_corners_ > kMostCorners) return nullptr;
  std::vector<Vec3> list;
  read_unplaced(part, [&](const Facet& f) { list.insert(list.end(), f.vertex.begin(), f.vertex.end()); });
  std::ranges::sort(list);
  list.erase(std::ranges::unique(list).begin(), list.end());
  list.shrink_to_fit();
  all_corners_ += list.size();
  return &corners_.emplace(shape, std::move(list)).first->second;
}

Vec3 PartTree::placed(const Vec3& v, const Part& part) const {
  Vec3 p = transform(part.matrix, v);
  for (double& x : p)
    if (!(std::abs(x) >= 1e-75 && std::abs(x) <= 1e75))  // rare: 0 is allowed, and -0 becomes +0
      x = checked_coordinate(x, fmt::format("{}: part {}: a vertex where the part stands", name_, shown(part.path)));
  return p;
}

}  // namespace teracell::mesher
