// VTK's XML file of an unstructured grid: each leaf is a hexahedron with its level and its material. Leaves share their points; where a finer leaf
// has one in the middle of a coarser one's edge or face, that hangs.
#include <fmt/format.h>

#include "store/base/output_file.hpp"
#include "store/grid/vtk_header.hpp"
#include "tools/export/arrays/dense.hpp"
#include "tools/export/place.hpp"
#include "tools/export/refined/leaf_points.hpp"

namespace teracell::exports {
namespace {

// The arrays of the file, one after another: each is filled from its beginning.
class Arrays {
 public:
  struct Array {
    const char *type, *name;
    uint64_t bytes;  // of all its values
    int components = 1;
    uint64_t at = 0;  // where the next value goes
  };

  Arrays(OutputFile& file, std::vector<Array> arrays) : file_(file), arrays_(std::move(arrays)) {}

  // The element that describes an array.
  std::string element(size_t i) const {
    const Array& a = arrays_[i];
    uint64_t offset = 0;
    for (size_t before = 0; before < i; ++before) offset += sizeof(uint64_t) + arrays_[before].bytes;
    return fmt::format("<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n", a.type, a.name,
                       a.components, offset);
  }
  // The header ends where the first array begins.
  void begin(const std::string& header) {
    uint64_t at = header.size();
    write(0, header.data(), header.size());
    for (Array& a : arrays_) {
      write(at, &a.bytes, sizeof a.bytes);
      a.at = at + sizeof a.bytes;
      at = a.at + a.bytes;
    }
    write(at, kVtkFooter, sizeof kVtkFooter - 1);
  }
  template <class T>
  void put(size_t i, const std::vector<T>& values) {
    write(arrays_[i].at, values.data(), values.size() * sizeof(T));
    arrays_[i].at += values.size() * sizeof(T);
  }

 private:
  void write(uint64_t at, const void* data, size_t bytes) { file_.write_at(at, {static_cast<const uint8_t*>(data), bytes}); }

  OutputFile& file_;
  std::vector<Array> arrays_;
};

enum { kLevel, kMaterial, kPoints, kConnectivity, kOffsets, kTypes };

struct BlockOfVtu {
  std::vector<uint8_t> level, material, types;
  std::vector<double> points;
  std::vector<int64_t> connectivity, offsets;
};

BlockOfVtu block_of_vtu(const Export& e, const LeafGrid& grid, const LeafPoints& points, const std::vector<uint32_t>& numbers, size_t bytes,
                        const Index3& at) {
  constexpr uint8_t kHexahedron = 12;
  BlockOfVtu out;
  const auto block = grid.block(at);
  const auto owned = points.block(at);
  NearLeaves near(grid, at);
  NearPoints near_points(points, near);
  for (uint32_t i = 0; i < block->size(); ++i) {
    const LeafAt leaf = near.leaf(*block, i);
    for (uint32_t place = 0; place < 27; ++place) {
      if ((owned->entries[i].points >> place & 1) == 0) continue;
      const Index3 p = LeafPoints::place(leaf, place);
      for (int d = 0; d < 3; ++d) out.points.push_back(plane_of(e, d, p[static_cast<size_t>(d)] - e.box.lo[static_cast<size_t>(d)]));
    }
    for (size_t corner = 0; corner < 8; ++corner) {  // x and y turn round the lower side, then round the upper one
      const bool x = corner % 4 == 1 || corner % 4 == 2, y = corner % 4 >= 2, z = corner >= 4;
      out.connectivity.push_back(
          near_points.number({x ? leaf.hi(0) : leaf.lo(0), y ? leaf.hi(1) : leaf.lo(1), z ? leaf.hi(2) : leaf.lo(2)}, 0, e.box));
    }
    out.offsets.push_back(8 * (leaf.number() + 1));
    out.types.push_back(kHexahedron);
    out.level.push_back(static_cast<uint8_t>(leaf.level));
    const uint32_t number = numbers[block->leaves[i].label];
    for (size_t b = 0; b < bytes; ++b) out.material.push_back(static_cast<uint8_t>(number >> (8 * b)));
  }
  return out;
}

void write_vtu(const Export& e) {
  if (!e.has("--refine")) throw UsageError("--refine: expected M,N, since the format vtu holds leaves, found none");
  const auto share = [&](double from, double to) { return [&e, from, to](double done) { e.progress(from + (to - from) * done); }; };
  const RefinedGrid refined(e, 0.1);
  const std::vector<MaterialInfo>& materials = e.reader.meta().materials;
  const MeshOfLeaves mesh{e.box, std::vector<bool>(materials.size(), true)};
  LeafGrid grid(refined, mesh);
  grid.number(share(0.1, 0.3));
  const PartBegins all{0, grid.cells()};
  LeafPoints points(grid, all);
  points.number(share(0.3, 0.6));

  const auto n = static_cast<uint64_t>(grid.cells()), p = static_cast<uint64_t>(points.points(0));
  const size_t bytes = bytes_per_cell(e.most());
  OutputFile file(e.output);
  Arrays arrays(file, {{"UInt8", "level", n},
                       {bytes == 1   ? "UInt8"
                        : bytes == 2 ? "UInt16"
                                     : "UInt32",
                        "material", n * bytes},
                       {"Float64", "points", 3 * sizeof(double) * p, 3},
                       {"Int64", "connectivity", 8 * sizeof(int64_t) * n},
                       {"Int64", "offsets", sizeof(int64_t) * n},
                       {"UInt8", "types", n}});
  arrays.begin(
      fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n"
                  "<UnstructuredGrid>\n{}<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">\n<CellData Scalars=\"material\">\n{}{}</CellData>\n"
                  "<Points>\n{}</Points>\n<Cells>\n{}{}{}</Cells>\n</Piece>\n</UnstructuredGrid>\n<AppendedData encoding=\"raw\">\n_",
                  e.map.empty() ? vtk_names(materials) : "", p, n, arrays.element(kLevel), arrays.element(kMaterial), arrays.element(kPoints),
                  arrays.element(kConnectivity), arrays.element(kOffsets), arrays.element(kTypes)));
  grid.for_each_block(
      share(0.6, 1), [&](const Index3& at) { return block_of_vtu(e, grid, points, refined.numbers(), bytes, at); },
      [&](const BlockOfVtu& block) {
        arrays.put(kLevel, block.level), arrays.put(kMaterial, block.material), arrays.put(kPoints, block.points);
        arrays.put(kConnectivity, block.connectivity), arrays.put(kOffsets, block.offsets), arrays.put(kTypes, block.types);
      });
  e.progress(1);
  file.commit();
}

}  // namespace

ExportFormat vtu_format() {
  return {.name = "vtu",
          .extensions = {".vtu"},
          .holds = "the leaves of a refined grid as hexahedra for VTK, ParaView and VisIt (with --refine)",
          .write = write_vtu,
          .options = refined_options()};
}

}  // namespace teracell::exports
