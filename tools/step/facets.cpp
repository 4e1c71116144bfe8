#include "tools/step/facets.hpp"

#include <sys/resource.h>

#include <BRep_Builder.hxx>
#include <BRep_Tool.hxx>
#include <BRepGProp.hxx>
#include <BRepMesh_IncrementalMesh.hxx>
#include <BRepTools.hxx>
#include <cmath>
#include <cstring>
#include <fstream>
#include <GProp_GProps.hxx>
#include <NCollection_DataMap.hxx>
#include <nlohmann/json.hpp>
#include <numeric>
#include <OSD_Parallel.hxx>
#include <OSD_ThreadPool.hxx>
#include <Poly_PolygonOnTriangulation.hxx>
#include <Poly_Triangulation.hxx>
#include <Standard_Failure.hxx>
#include <stdexcept>
#include <TopExp.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS.hxx>
#include <TopoDS_Compound.hxx>
#include <TopoDS_Edge.hxx>
#include <TopoDS_Face.hxx>
#include <TopoDS_Vertex.hxx>
#include <TopTools_ShapeMapHasher.hxx>

#include "mesher/cad/facets_file.hpp"

namespace teracell::step {
namespace {

// The triangles of a shape over vertices that neighbouring faces share.
struct Mesh {
  std::vector<std::array<double, 3>> vertices;
  struct Group {
    std::string color;  // of faces that have one of their own; "" for the others
    std::vector<std::array<uint32_t, 3>> triangles;
  };
  std::vector<Group> groups;
  size_t faces_without_facets = 0;
};

// Faces have nodes of their own. Those that lie on the same edge, at the same place of its polygon, are one vertex, and so are those at
// one vertex of the shape: that is known from the topology, so no distance decides it and no gap can stay open.
class Welding {
 public:
  explicit Welding(const Shape& shape) : shape_(shape) {
    for (TopExp_Explorer face(shape.shape, TopAbs_FACE); face.More(); face.Next()) take(TopoDS::Face(face.Current()));
  }

  Mesh mesh() {
    Mesh out;
    out.faces_without_facets = without_;
    std::vector<uint32_t> number(points_.size(), ~uint32_t{0});
    const auto vertex = [&](uint32_t node) {
      const uint32_t root = find(node);
      if (number[root] == ~uint32_t{0}) {
        number[root] = static_cast<uint32_t>(out.vertices.size());
        out.vertices.push_back(points_[root]);
      }
      return number[root];
    };
    std::unordered_map<std::string, size_t> groups;
    for (const FaceNodes& face : faces_) {
      const auto colored = shape_.face_color.find(face.face.TShape().get());
      const std::string color = colored == shape_.face_color.end() ? "" : colored->second;
      const auto [group, fresh] = groups.try_emplace(color, out.groups.size());
      if (fresh) out.groups.push_back({color, {}});
      const bool turned = face.face.Orientation() == TopAbs_REVERSED;
      for (int i = 1; i <= face.triangles->NbTriangles(); ++i) {
        int a, b, c;
        face.triangles->Triangle(i).Get(a, b, c);
        if (turned) std::swap(b, c);
        const std::array<uint32_t, 3> t = {vertex(face.node(a)), vertex(face.node(b)), vertex(face.node(c))};
          // Of a triangle with two equal corners the two other edges are each other's reverse, so leaving it out opens nothing.
        if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) out.groups[group->second].triangles.push_back(t);
      }
    }
    return out;
  }

 private:
  struct FaceNodes {
    TopoDS_Face face;
    Handle(Poly_Triangulation) triangles;
    uint32_t first;
    uint32_t node(int i) const { return first + static_cast<uint32_t>(i - 1); }
  };

  uint32_t find(uint32_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  // The lowest number stands for all, so that the result depends on the shape alone.
  void join(uint32_t a, uint32_t b) {
    a = find(a), b = find(b);
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
  }

  void take(const TopoDS_Face& face) {
    if (face.Orientation() != TopAbs_FORWARD && face.Orientation() != TopAbs_REVERSED) return;  // it bounds nothing
    TopLoc_Location location;
    const Handle(Poly_Triangulation) triangles = BRep_Tool::Triangulation(face, location);
    if (triangles.IsNull() || triangles->NbTriangles() == 0) {
      ++without_;
      return;
    }
    const FaceNodes nodes = {face, triangles, static_cast<uint32_t>(points_.size())};
    faces_.push_back(nodes);
    for (int i = 1; i <= triangles->NbNodes(); ++i) {
      const gp_Pnt p = location.IsIdentity() ? triangles->Node(i) : triangles->Node(i).Transformed(location.Transformation());
      parent_.push_back(static_cast<uint32_t>(points_.size()));
      points_.push_back({p.X(), p.Y(), p.Z()});
    }
    for (TopExp_Explorer edge(face, TopAbs_EDGE); edge.More(); edge.Next()) join_along(TopoDS::Edge(edge.Current()), nodes, location);
  }

  void join_along(const TopoDS_Edge& edge, const FaceNodes& face, const TopLoc_Location& location) {
    const Handle(Poly_PolygonOnTriangulation) polygon = BRep_Tool::PolygonOnTriangulation(edge, face.triangles, location);
    if (polygon.IsNull() || polygon->NbNodes() == 0) return;
    std::vector<uint32_t> nodes;
    for (int i = 1; i <= polygon->NbNodes(); ++i) nodes.push_back(face.node(polygon->Node(i)));
    TopoDS_Vertex from, to;
    TopExp::Vertices(TopoDS::Edge(edge.Oriented(TopAbs_FORWARD)), from, to);
    if (!from.IsNull()) join_to(vertices_, from, nodes.front());
    if (!to.IsNull()) join_to(vertices_, to, nodes.back());
    if (BRep_Tool::Degenerated(edge)) {
      for (const uint32_t n : nodes) join(nodes.front(), n);
      return;
    }
    if (const auto* known = edges_.Seek(edge)) {
      if (known->size() == nodes.size())
        for (size_t i = 0; i < nodes.size(); ++i) join((*known)[i], nodes[i]);
    } else {
      edges_.Bind(edge, nodes);
    }
  }

  template <class Map>
  void join_to(Map& map, const TopoDS_Shape& key, uint32_t node) {
    if (const uint32_t* known = map.Seek(key)) join(*known, node);
    else map.Bind(key, node);
  }

  const Shape& shape_;
  std::vector<FaceNodes> faces_;
  std::vector<std::array<double, 3>> points_;
  std::vector<uint32_t> parent_;
  NCollection_DataMap<TopoDS_Shape, std::vector<uint32_t>, TopTools_ShapeMapHasher> edges_;  // the same edge, whatever its orientation
  NCollection_DataMap<TopoDS_Shape, uint32_t, TopTools_ShapeMapHasher> vertices_;
  size_t without_ = 0;
};

// Whether this program has come near to its limit at any time.
bool is_memory_short() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return false;
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;)
    if (uint64_t kib = 0; word == "VmPeak:" && status >> kib) return kib * 1024 > limit.rlim_cur / 8 * 7;
  return false;
}

uint64_t mixed(uint64_t x) {  // the finaliser of SplitMix64
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9;
  x = (x ^ x >> 27) * 0x94d049bb133111eb;
  return x ^ x >> 31;
}

// Whether each edge is matched by its reverse: then the sum of hashes over edges, less that over their reverses, is 0.
bool is_closed(const Mesh& mesh) {
  uint64_t sum = 0;
  const auto hash = [](uint64_t a, uint64_t b) { return mixed((a << 32 | b) + 0x9e3779b97f4a7c15); };
  for (const Mesh::Group& g : mesh.groups)
    for (const auto& t : g.triangles)
      for (size_t k = 0; k < 3; ++k) sum += hash(t[k], t[(k + 1) % 3]) - hash(t[(k + 1) % 3], t[k]);
  return sum == 0 && !mesh.vertices.empty();
}

struct Measures {
  double volume = 0, area = 0;
};

Measures measure(const Mesh& mesh) {
  long double volume = 0, area = 0;
  const auto less = [](const auto& a, const auto& b) { return std::array{a[0] - b[0], a[1] - b[1], a[2] - b[2]}; };
  const auto cross = [](const auto& a, const auto& b) {
    return std::array{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  };
  for (const Mesh::Group& g : mesh.groups)
    for (const auto& t : g.triangles) {
      const auto& origin = mesh.vertices[0];
      const auto a = less(mesh.vertices[t[0]], origin), b = less(mesh.vertices[t[1]], origin), c = less(mesh.vertices[t[2]], origin);
      const auto m = cross(b, c), n = cross(less(b, a), less(c, a));
      volume += (a[0] * m[0] + a[1] * m[1] + a[2] * m[2]) / 6;
      area += std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]) / 2;
    }
  return {static_cast<double>(volume), static_cast<double>(area)};
}

// The volume of the exact shape, by adaptive integration. With a fixed number of points the kernel is 0.6 % off for a bolt whose
// cylinders are rational splines.
std::optional<double> exact_volume(const TopoDS_Shape& shape) {
  constexpr double kRelativeError = 1e-4;
  if (shape.ShapeType() != TopAbs_SOLID) return std::nullopt;
  try {
    GProp_GProps found;
    BRepGProp::VolumePropertiesGK(shape, found, kRelativeError);
    const double volume = std::abs(found.Mass());
    return std::isfinite(volume) ? std::optional(volume) : std::nullopt;
  } catch (const Standard_Failure&) {
    return std::nullopt;
  }
}

// Shapes are tessellated some at a time: many small ones together keep all threads busy, as one large one does.
void tessellate(const Model& model, const Tolerances& tolerances, const std::function<void(double)>& progress) {
  constexpr size_t kFaces = 512;
  size_t all = 0, done = 0;
  for (const Shape& s : model.shapes) {
    all += s.faces;
    BRepTools::Clean(s.shape, true);  // of what the file brings, or was made for others: it would stay where it is finer
  }
  IMeshTools_Parameters parameters;
  parameters.Deflection = tolerances.deflection;
  parameters.Angle = tolerances.angle * M_PI / 180;
  parameters.InParallel = tolerances.threads > 1;
  for (size_t next = 0; next < model.shapes.size();) {
    TopoDS_Compound some;
    BRep_Builder builder;
    builder.MakeCompound(some);
    size_t faces = 0;
    for (; next < model.shapes.size() && faces < kFaces; ++next) {
      builder.Add(some, model.shapes[next].shape);
      faces += model.shapes[next].faces;
    }
    const BRepMesh_IncrementalMesh mesher(some, parameters);  // its constructor does the work
    done += faces;
    progress(static_cast<double>(done) / static_cast<double>(all));
  }
}

class Output {
 public:
  explicit Output(const std::string& path) : path_(path), file_(path, std::ios::binary | std::ios::trunc) { check(); }
  template <class T>
  void put(const T* data, size_t count) {
    file_.write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(count * sizeof(T)));
    check();
  }
  void close() {
    file_.close();
    check();
  }

 private:
  void check() const {
    if (!file_) throw std::runtime_error("can't write " + path_ + ": " + std::strerror(errno));
  }
  std::string path_;
  std::ofstream file_;
};

}  // namespace

void write_facets(const Model& model, const Tolerances& tolerances, const std::string& path, const std::function<void(double)>& progress) {
  OSD_Parallel::SetUseOcctThreads(true);
  OSD_ThreadPool::DefaultPool(tolerances.threads)->SetNbDefaultThreadsToLaunch(tolerances.threads);
  tessellate(model, tolerances, progress);
  std::vector<std::optional<double>> exact(model.shapes.size());
  OSD_Parallel::For(
      0, static_cast<int>(model.shapes.size()),
      [&](int i) { exact[static_cast<size_t>(i)] = exact_volume(model.shapes[static_cast<size_t>(i)].shape); }, tolerances.threads == 1);
  nlohmann::json shapes = nlohmann::json::array();
  std::vector<Mesh> meshes;
  size_t without = 0;
  for (size_t i = 0; i < model.shapes.size(); ++i) {
    const Shape& shape = model.shapes[i];
    const Mesh& mesh = meshes.emplace_back(Welding(shape).mesh());
    without += mesh.faces_without_facets;
    const Measures facets = measure(mesh);
    nlohmann::json groups = nlohmann::json::array();
    for (const Mesh::Group& g : mesh.groups) groups.push_back({{"color", g.color}, {"triangles", g.triangles.size()}});
    shapes.push_back({{"vertices", mesh.vertices.size()},
                      {"groups", groups},
                      {"faces_without_facets", mesh.faces_without_facets},
                      {"closed", is_closed(mesh)},
                      {"facet_volume", facets.volume},
                      {"facet_area", facets.area},
                      {"kernel_volume", exact[i] ? nlohmann::json(*exact[i]) : nlohmann::json()}});
  }
  // Where the kernel runs out of memory it leaves the face out without a word.
  if (without > 0 && is_memory_short()) throw std::bad_alloc();
  const std::string head = nlohmann::json({{"shapes", shapes}}).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  Output out(path);
  const uint64_t bytes = head.size();
  out.put(mesher::kFacetsMagic.data(), mesher::kFacetsMagic.size());
  out.put(&bytes, 1);
  out.put(head.data(), head.size());
  for (const Mesh& mesh : meshes) {
    out.put(mesh.vertices.data(), mesh.vertices.size());
    for (const Mesh::Group& g : mesh.groups) out.put(g.triangles.data(), g.triangles.size());
  }
  out.close();
}

}  // namespace teracell::step
