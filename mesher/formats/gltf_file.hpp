// A glTF or GLB file as numbers: its lists in JSON, and the accessors, which say how the bytes of buffers are to be read. What they mean for
// shapes is in gltf.cpp. "glTF 2.0 Specification", Khronos Group, 2021.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mesher/surface/contents.hpp"
#include "mesher/surface/facet.hpp"
#include "mesher/surface/matrix.hpp"
#include "store/text/json_node.hpp"

namespace teracell::mesher {

struct GltfNode {
  std::string name;
  std::optional<uint32_t> mesh;
  Matrix matrix = kIdentity;
  std::vector<uint32_t> children;
};
struct GltfPrimitive {
  uint32_t positions;
  std::optional<uint32_t> indices, material;
  uint32_t mode = 4;  // triangles
};
struct GltfMesh {
  std::string name;
  std::vector<GltfPrimitive> primitives;
};
struct GltfMaterial {
  std::string name, color;
};

class GltfFile {
 public:
  // Reads the lists. Buffers beside the file are opened when they are needed; their bytes count for bytes and hash of `file`.
  GltfFile(Input& input, SurfaceFile& file, const Budget& budget);

  const std::string& name() const { return name_; }
  std::vector<GltfNode> take_nodes() { return std::move(nodes_); }  // after roots()
  const std::vector<GltfMesh>& meshes() const { return meshes_; }
  const std::vector<GltfMaterial>& materials() const { return materials_; }
  // The nodes at the root of the default scene, else of the first; of a file without scenes all nodes that are no children.
  std::vector<uint32_t> roots() const;

  bool is_float(uint32_t accessor) const;
  // Calls take(element) for each element in order, with its three or one components. Throws InputError when bytes are missing.
  void read_vectors(uint32_t accessor, const std::function<void(const Vec3&)>& take);
  void read_scalars(uint32_t accessor, const std::function<void(uint64_t)>& take);
  // Counts bytes that are made of buffers. Throws InputError when these are far more than the buffers have: some kilobytes could describe
  // more triangles than any disk holds.
  void spend(uint64_t bytes, const std::string& where);

 private:
  struct Buffer {
    std::string uri;  // empty: the GLB's own
    uint64_t declared = 0;              // bytes that it has
    bool opened = false;
    std::string decoded;                // of a data URI, or
    std::unique_ptr<Contents> beside;  // a file
  };
  struct View {
    uint32_t buffer;
    uint64_t offset, bytes, stride;
  };
  struct Stretch {  // of a view
    std::optional<uint32_t> view;
    uint64_t offset = 0;
    uint32_t type = 0;
  };
  struct Accessor {
    Stretch values;
    bool normalized = false;
    uint64_t count = 0;
    std::string shape;  // "VEC3", "SCALAR"
    uint64_t replaced = 0;
    Stretch indices, replacements;  // of those that are replaced
  };

  void read_container(const Contents& contents);
  void parse(const std::string& text);
  void take(const std::string& list, const JsonNode& element);
  GltfNode node_of(const JsonNode& j) const;
  GltfMesh mesh_of(const JsonNode& j);
  Accessor accessor_of(const JsonNode& j) const;
  const Accessor& at(uint32_t accessor) const;
  template <class F>
  void read_numbers(const Stretch& from, uint64_t count, size_t components, bool normalized, const std::string& where, F&& take);
  template <class F>
  void read_elements(const Accessor& a, size_t components, const std::string& where, F&& take);
  void read_bytes(uint32_t buffer, uint64_t offset, std::span<char> out);
  void open(uint32_t buffer);
  [[noreturn]] void refuse(const std::string& where, const std::string& why) const;

  const std::string name_;
  const bool on_disk_;
  SurfaceFile& file_;
  const Budget budget_;
  const std::unique_ptr<Contents> contents_;
  uint64_t binary_at_ = 0, binary_bytes_ = 0;  // of the GLB's own buffer
  uint64_t all_bytes_ = 0, read_bytes_ = 0;    // of the buffers that were opened; that were made of them
  uint64_t small_bytes_ = 0;                   // of files that were read as a whole
  size_t primitives_ = 0;
  std::optional<uint32_t> scene_;
  std::vector<std::vector<uint32_t>> scenes_;
  std::vector<GltfNode> nodes_;
  std::vector<GltfMesh> meshes_;
  std::vector<GltfMaterial> materials_;
  std::vector<Accessor> accessors_;
  std::vector<View> views_;
  std::vector<Buffer> buffers_;
};

}  // namespace teracell::mesher
