// An assembly: parts at their places in a tree, and the facets of each shape once, however many parts have that shape. What a format with a
// tree (3MF, glTF) makes of a file. Vertices and triangles that don't fit into the budget lie on disk.
#pragma once
#include <algorithm>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "mesher/surface/facet.hpp"
#include "mesher/surface/matrix.hpp"
#include "mesher/surface/part_path.hpp"
#include "mesher/surface/spill_table.hpp"
#include "mesher/surface/units.hpp"

namespace teracell::mesher {

// Facets of a shape that follow each other and whose faces have one colour.
struct ColorGroup {
  std::string color;  // "#rrggbb"; empty: that of the part
  uint64_t facets;
};

// The facets of all shapes of a file, in its coordinates.
class Shapes {
 public:
  // Memory holds at most 128 MiB of vertices and as much of triangles; less where the budget has less.
  explicit Shapes(const Budget& budget) : vertices_(at_most(budget)), triangles_(at_most(budget)) {}

  // Vertices that triangles of one or more shapes name by number: those that are added until the next call.
  uint32_t begin_vertices(bool float32);
  void add_vertex(const Vec3& v) { vertices_.push_back(v); }
  // The same times a factor. Throws InputError, which begins with `where`, when it leaves the range of coordinates.
  void add_vertex(const Vec3& v, const Factor& by, const std::string& where);
  // The vertices of a set that are there.
  uint64_t vertices(uint32_t set) const { return (set + 1 < sets_.size() ? sets_[set + 1].first : vertices_.size()) - sets_[set].first; }

  // A new shape, to which triangles are added until the next call.
  uint32_t begin_shape(bool stands_for_facets = false);
  // The triangles that follow are of faces with this colour ("": that of the part). Not called: all have that of the part.
  void begin_group(std::string color) { shapes_.back().groups.push_back({std::move(color), 0}); }
  // REQUIRES: the numbers are below vertices(set).
  void add_triangle(uint32_t set, const std::array<uint32_t, 3>& numbers);
  uint64_t facets(uint32_t shape) const { return shapes_[shape].facets; }
  // Whether a part of this shape counts as one.
  bool is_part(uint32_t shape) const { return shapes_[shape].facets > 0 || shapes_[shape].stands_for_facets; }
  bool float32(uint32_t shape) const { return shapes_[shape].float32; }
  const std::vector<ColorGroup>& groups(uint32_t shape) const { return shapes_[shape].groups; }
  // Calls f(a, b, c) with the vertices of each facet, in the order in which they were added.
  template <class F>
  void for_each(uint32_t shape, F&& f) {
    pass(*this, shape, f);
  }
  // The same for several threads at once. REQUIRES: in_memory().
  template <class F>
  void for_each(uint32_t shape, F&& f) const {
    pass(*this, shape, f);
  }
  uint64_t facets() const { return triangles_.size(); }  // of all shapes
  bool in_memory() const { return vertices_.in_memory() && triangles_.in_memory(); }
  uint64_t bytes_in_memory() const { return vertices_.bytes_in_memory() + triangles_.bytes_in_memory(); }

 private:
  struct Set {
    uint64_t first;
    bool float32;
  };
  struct Stretch {  // of triangles of one set
    uint32_t set;
    uint64_t first, count;
  };
  struct Shape {
    std::vector<Stretch> stretches;
    std::vector<ColorGroup> groups;
    uint64_t facets = 0;
    bool float32 = true;
    bool stands_for_facets = false;  // that were not made
  };
  static Budget at_most(Budget budget) {
    budget.bytes = std::min(budget.bytes, uint64_t{1} << 30);
    return budget;
  }
  template <class Self, class F>
  static void pass(Self& self, uint32_t shape, F&& f) {
    for (const Stretch& s : self.shapes_[shape].stretches)
      for (uint64_t i = 0; i < s.count; ++i) {
        const std::array<uint32_t, 3> numbers = self.triangles_[s.first + i];
        const uint64_t first = self.sets_[s.set].first;
        const Vec3 a = self.vertices_[first + numbers[0]], b = self.vertices_[first + numbers[1]];
        f(a, b, self.vertices_[first + numbers[2]]);
      }
  }
  VertexTable vertices_;
  TriangleTable triangles_;
  std::vector<Set> sets_;
  std::vector<Shape> shapes_;
};

// Something that has a name in the tree. Of a node that is used more than once, everything below it is there as often.
struct PartNode {
  std::string name;                       // where its use has none
  std::string product, color, material;   // of its shape; color "#rrggbbaa"; all may be empty
  std::optional<uint32_t> shape;
  struct Use {
    uint32_t node;
    Matrix matrix = kIdentity;
    std::string name;  // may be empty
  };
  std::vector<Use> uses;
};

// A leaf of the tree: where a shape stands.
struct Part {
  std::string path;  // as in part_path.hpp
  uint32_t node;     // its number in PartTree::nodes(), which has a shape
  Matrix matrix;     // all matrices along the path, the root's first
};

class PartTree {
 public:
  // Throws InputError for a tree without end, too many parts, too deep a tree. `name` is that of the file, for messages.
  PartTree(std::string name, Shapes&& shapes, std::vector<PartNode>&& nodes, const std::vector<PartNode::Use>& roots);

  const std::string& name() const { return name_; }
  const std::vector<Part>& parts() const { return parts_; }  // in the order of the tree, a node before those below it
  const PartNode& node(const Part& part) const { return nodes_[part.node]; }
  // The parts that a body takes: their numbers in parts(), ascending.
  std::vector<uint32_t> matching(const PartGlob& glob);
  bool float32(const Part& part) const { return part.matrix == kIdentity && shapes_.float32(*node(part).shape); }
  uint64_t facets(const Part& part) const { return shapes_.facets(*node(part).shape); }
  const std::vector<ColorGroup>& groups(const Part& part) const { return shapes_.groups(*node(part).shape); }
  // Most parts are copies of others, and there are so many of them that their facets are worth having once (a thousand bolts).
  bool repeats() const { return repeats(facets_); }
  bool repeats(uint64_t facets) const { return facets > kFewFacets && facets / 4 > shapes_.facets(); }  // of so many facets of parts
  bool in_memory() const { return shapes_.in_memory(); }
  uint64_t bytes_in_memory() const { return shapes_.bytes_in_memory(); }
  // Calls f(facet) with each of its facets where it stands. Throws InputError when a vertex leaves the range of coordinates.
  template <class F>
  void read(const Part& part, F&& f) {
    pass(*this, shapes_, part, f);
  }
  // The same for several threads at once. REQUIRES: in_memory().
  template <class F>
  void read(const Part& part, F&& f) const {
    pass(*this, shapes_, part, f);
  }
  // Calls f(vertex) with each vertex of its facets where it stands, once where the shape is small. One thread at a time may call this.
  template <class F>
  void for_each_vertex(const Part& part, F&& f) {
    const auto* corners = corners_of(part);
    if (!corners)
      return read(part, [&](const Facet& facet) {
        for (const Vec3& v : facet.vertex) f(v);
      });
    const bool moves = part.matrix != kIdentity;
    for (const Vec3& v : *corners) f(moves ? placed(v, part) : v);
  }
  // Its facets as the file has them, in the shape's coordinates.
  template <class F>
  void read_unplaced(const Part& part, F&& f) {
    shapes_.for_each(*node(part).shape, [&](const Vec3& a, const Vec3& b, const Vec3& c) { f(Facet{{a, b, c}}); });
  }

 private:
  static constexpr uint64_t kFewFacets = uint64_t{1} << 17;  // take some 20 MB
  template <class S, class F>
  static void pass(const PartTree& tree, S& shapes, const Part& part, F&& f) {
    const bool moves = part.matrix != kIdentity, swaps = mirrors(part.matrix);
    shapes.for_each(*tree.node(part).shape, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
      Facet facet{{a, swaps ? c : b, swaps ? b : c}};
      if (moves)
        for (Vec3& v : facet.vertex) v = tree.placed(v, part);
      f(facet);
    });
  }
  Vec3 placed(const Vec3& v, const Part& part) const;
  const std::vector<Vec3>* corners_of(const Part& part);
  void visit(const std::vector<PartNode::Use>& uses, const std::string& above, const Matrix& matrix, size_t depth);
  std::string name_;
  Shapes shapes_;
  std::vector<PartNode> nodes_;
  std::vector<Part> parts_;
  uint64_t path_bytes_ = 0, name_bytes_ = 0, visited_ = 0, facets_ = 0;  // facets_ of all parts
  // Made when they are needed:
  std::unordered_map<std::string_view, uint32_t> by_path_;
  std::unordered_map<uint32_t, std::vector<Vec3>> corners_;  // the vertices of a shape, each once
  uint64_t all_corners_ = 0;
};

}  // namespace teracell::mesher
