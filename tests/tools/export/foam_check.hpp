// What the mesh of a grid must be, told cell by cell, and the comparison with what was exported.
#pragma once
#include "store/read/reader.hpp"
#include "tests/tools/export/foam_files.hpp"

namespace teracell::testing::foam {

struct Expected {
  Expected(const GridReader& reader, int level, const Box& of, double to_metres, const std::set<uint32_t>& mesh_materials);
  bool inside(const Index3& c) const {
    for (int d = 0; d < 3; ++d)
      if (c[d] < 0 || c[d] >= n[d]) return false;
    return true;
  }
  size_t at(const Index3& c) const { return static_cast<size_t>((c[2] * n[1] + c[1]) * n[0] + c[0]); }
  Index3 place(size_t i) const {
    const auto k = static_cast<int64_t>(i);
    return {k % n[0], k / n[0] % n[1], k / n[0] / n[1]};
  }
  // Leaves only the largest region; the first of those that are equally large.
  void drop_unreachable();
  // The patch of the face of a cell beyond which lies `c`: a side of the box, what the surface's links name, or the material.
  std::string patch(const Index3& own, const Index3& c) const;
  // Takes the patches of the links.
  void read_patches(const GridReader& reader);

  Box box;
  Index3 n;
  std::array<std::vector<double>, 3> planes;
  std::vector<uint32_t> material;
  std::vector<bool> in_mesh;
  std::vector<int64_t> number;
  std::vector<size_t> cells;
  std::vector<std::string> names;
  std::map<std::pair<Index3, Index3>, std::string> patches;  // between neighbouring cells of the box, the lower one first

 private:
  void number_cells();
};

std::vector<int64_t> all_numbers(const Expected& e);

// A mesh of the cells with these numbers, in this order: all its faces lie where they should, once, and in the right lists.
void check_mesh(const Expected& e, const PolyMesh& mesh, const std::vector<int64_t>& cells, bool divided);
void check_zones(const Expected& e, const PolyMesh& mesh, const std::vector<int64_t>& cells);
// Parts of the mesh and what they say of the whole one.
void check_parts(const Expected& e, const PolyMesh& whole, const std::filesystem::path& folder, int ranks, bool zones);

}  // namespace teracell::testing::foam
