// A STEP file by way of the CAD kernel: its tree, its box, its facets. What the kernel made before comes from the cache, without the kernel.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "mesher/cad/facet_cache.hpp"
#include "mesher/surface/input.hpp"
#include "mesher/surface/part_tree.hpp"
#include "mesher/surface/read_options.hpp"
#include "store/base/file.hpp"

namespace teracell::mesher {

class KernelProcess;

// The kernel's lengths are in millimetres.
inline constexpr const char* kKernelUnit = "mm";

// A shape of the file where a matrix puts it.
struct CadInstance {
  uint32_t shape;
  Matrix matrix;  // from the kernel's coordinates
};

// Not to be shared by threads. Everything throws InputError or IoError with the file's name, and what options.waiting throws.
class CadModel {
 public:
  // Takes the input to its end, and passes its bytes to `each`. `options` must outlive this.
  CadModel(Input& input, const Budget& budget, const CadOptions& options, const std::function<void(std::string_view)>& each);
  ~CadModel();
  CadModel(const CadModel&) = delete;

  struct Outline {
    std::vector<PartNode> nodes;  // translations in the kernel's unit
    std::vector<PartNode::Use> roots;
    std::vector<CadShape> shapes;  // without what only the facets tell
  };
  Outline outline();
  // The lower and the upper corner. REQUIRES: there are instances.
  std::array<Vec3, 2> box(const std::vector<CadInstance>& instances);
  // Adds a set of vertices and a shape for each shape of the outline, in its order. `factor`: from the kernel's unit. `deflection` is in that
  // unit. Returns what the kernel said.
  CadFacts add_facets(Shapes& shapes, double deflection, const Factor& factor, std::vector<CadShape> facts);

 private:
  std::string find_version();
  void start();
  void read();
  void expect_unchanged() const;
  std::string key(const std::string& what) const;
  Descriptor lock(const std::string& what) const;
  KernelProcess& kernel();
  Outline outline_in(const std::string& text) const;
  const std::string name_;
  const CadOptions& options_;
  FacetCache cache_;
  FileState state_;  // of the file that was hashed; none for a copy of it
  Descriptor file_;
  std::filesystem::path program_;
  std::string file_hash_, version_;
  std::string outline_;  // as the kernel gave it, once it is known
  std::unique_ptr<KernelProcess> kernel_;
  bool read_ = false;  // the kernel has read the file
};

}  // namespace teracell::mesher
