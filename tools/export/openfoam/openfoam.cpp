// OpenFOAM's polyMesh: cells of chosen materials, with a patch for each material and each side of the domain that they touch.
//
// The cells are gone through two or three times: to find what hangs together or how many cells there are, if that is asked for; to count
// points and faces; to write. Counting first costs a tenth of writing, and every list has its place in its file from the beginning.
#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "store/base/error.hpp"
#include "store/read/stats.hpp"
#include "tools/export/openfoam/case_folder.hpp"
#include "tools/export/openfoam/dictionaries.hpp"
#include "tools/export/openfoam/refined_mesh.hpp"
#include "tools/export/solvers.hpp"

namespace teracell::exports {
namespace foam {
namespace {

std::vector<bool> cells_of_mesh(const Export& e) {
  if (e.has("--fluid")) return e.materials("--fluid");
  std::vector<bool> out(e.reader.meta().materials.size(), e.has("--zones"));
  out[0] = true;
  return out;
}

uint32_t ranks_of(const Export& e) { return static_cast<uint32_t>(e.integer("--ranks", 1, 100'000, 1)); }

MeshNames names_of(const Export& e, const MeshCounts& counts) {
  static constexpr const char* kSideNames[] = {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  const std::vector<MaterialInfo>& materials = e.reader.meta().materials;
  MeshNames out;
  std::set<std::string> patches(std::begin(kSideNames), std::end(kSideNames)), zones;
  // OpenFOAM's own names are of walls between ranks.
  const auto word_of = [&](const std::string& name) { return word(name.starts_with("procBoundary") ? "patch_" + name : name, patches); };
  // Patches of the surface first: they are often called as the material is, which is beyond the few faces of which no patch is known.
  for (auto it = counts.patches.lower_bound(kSurface); it != counts.patches.end(); ++it)
    out.patches[it->first] = {word_of(e.reader.meta().patches[it->first - kSurface].name), "wall"};
  for (auto it = counts.patches.begin(); it != counts.patches.end() && it->first < kSurface; ++it)
    out.patches[it->first] =
        it->first >= kSides ? NamedPatch{kSideNames[it->first - kSides], "patch"} : NamedPatch{word_of(materials[it->first].name), "wall"};
  if (!e.has("--zones")) return out;
  std::set<uint32_t> found;
  for (const PartCounts& part : counts.parts)
    for (const auto& [material, cells] : part.zones) found.insert(material);
  for (const uint32_t material : found) out.zones[material] = word(materials[material].name, zones);
  return out;
}

// Each face has four entries in the list of corners.
bool fits_labels(int64_t points, int64_t cells, int64_t faces) { return points <= kMostLabel && cells <= kMostLabel && faces <= kMostFaces; }

void expect_labels(const MeshCounts& counts) {
  for (const PartCounts& part : counts.parts)
    if (!fits_labels(part.points, part.cells, (part.all_corners() + 3) / 4))
      throw UsageError(fmt::format("OpenFOAM's 32-bit labels hold a mesh of {} faces, a part of this one has {}: give --ranks {} or more", kMostFaces,
                                   part.all_faces(), counts.all_faces() / (kMostFaces * 9 / 10) + 1));
}

// Going through 10^12 cells takes half an hour, but how many there are is known at once. A mesh has more than three faces for each.
void expect_labels_for_cells(const Export& e, const Division& d, uint32_t ranks) {
  if (e.level > 0 || e.has("--drop-unreachable")) return;
  const std::vector<CellStats> stats = read_stats(e.reader, e.box);
  double faces = 0;
  for (size_t id = 0; id < stats.size(); ++id)
    if (d.in_mesh[id]) faces += 3 * static_cast<double>(stats[id].cells);
  if (faces / ranks > kMostFaces)
    throw UsageError(
        fmt::format("OpenFOAM's 32-bit labels hold a mesh of {} faces, a part of this one has at least {:.0f}: give --ranks {:.0f} or more",
                    kMostFaces, faces / ranks, std::floor(faces / (kMostFaces * 0.9)) + 1));
}

void expect_cells(const Export& e, const Division& d, int64_t cells) {
  if (cells > 0) return;
  throw UsageError(fmt::format("the mesh would have no cell: expected cells of {} in the box, found none; --fluid chooses other materials",
                               chosen_names(e.reader.meta().materials, d.in_mesh)));
}

// Finds the regions, if that is asked for, and the number of cells.
int64_t look(const Division& d, Regions* regions, const std::function<void(int64_t layers)>& progress) {
  LayerReader reader(d.e, d.in_mesh);
  Layer layer;
  int64_t cells = 0;
  for (int64_t z = 0; z < size_of(d.e.box)[2]; ++z) {
    progress(z);
    reader.read(z, layer);
    for (const CellRun& run : layer.runs)
      if (run.in_mesh()) cells += run.end - run.begin;
    if (regions != nullptr) regions->add(layer);
  }
  if (regions == nullptr || cells == 0) return cells;
  regions->finish();
  return regions->cells_kept();
}

std::vector<int64_t> begins_of_parts(int64_t cells, uint32_t ranks) {
  if (cells < ranks) throw UsageError(fmt::format("--ranks: expected at most one rank per cell, found {} ranks for {} cells", ranks, cells));
  std::vector<int64_t> out;
  for (uint32_t part = 0; part <= ranks; ++part) out.push_back(cells / ranks * part + std::min<int64_t>(part, cells % ranks));
  return out;
}

// The edge of the coarsest cells in metres, if cells are cubes; else 0.
double coarsest_edge(const Grid& grid, int coarsest, double scale) {
  for (const Axis& axis : grid.axis)
    if (axis.is_graded() || axis.step() != grid.axis[0].step()) return 0;
  return grid.axis[0].step() * static_cast<double>(int64_t{1} << coarsest) * scale;
}

// Leaves of an octree in place of equal cells.
void write_refined(const Export& e, const Division& division, const CaseFolder& folder, uint32_t ranks, double scale) {
  const auto share = [&](double from, double to) { return [&e, from, to](double done) { e.progress(from + (to - from) * done); }; };
  const RefinedGrid refined(e, 0.1);
  RefinedMesh mesh(e, refined, division.in_mesh, division.links, e.has("--drop-unreachable"), share(0.1, 0.2));
  expect_cells(e, division, mesh.cells());
  const MeshCounts counts = mesh.count(begins_of_parts(mesh.cells(), ranks), share(0.2, 0.5));
  expect_labels(counts);
  MeshNames names = names_of(e, counts);
  names.refined_from = coarsest_edge(e.reader.meta().grid, refined.refinement().coarsest, scale);
  mesh.write(counts, names, {[&](uint32_t part) { return folder.mesh(part); }, scale}, share(0.5, 1));
  e.progress(1);
}

void write_equal(const Export& e, Division& division, const CaseFolder& folder, uint32_t ranks, double scale) {
  Regions regions;
  const auto layers = static_cast<double>(size_of(e.box)[2]);
  const auto share = [&](double from, double to) {
    return [&, from, to](int64_t done) { e.progress(from + (to - from) * static_cast<double>(done) / layers); };
  };
  if (ranks > 1 || e.has("--drop-unreachable")) {
    const int64_t cells = look(division, e.has("--drop-unreachable") ? &regions : nullptr, share(0, 0.1));
    expect_cells(e, division, cells);
    division.part_begin = begins_of_parts(cells, ranks);
    if (e.has("--drop-unreachable")) division.regions = &regions;
  }
  const MeshCounts counts = count(division, share(0.1, 0.25));
  expect_cells(e, division, counts.cells);
  expect_labels(counts);
  MeshNames names = names_of(e, counts);
  names.addressing = e.has("--ranks") && fits_labels(counts.points, counts.cells, counts.all_faces());
  write_mesh(division, counts, names, {[&](uint32_t part) { return folder.mesh(part); }, scale}, share(0.25, 1));
}

void write_case(const Export& asked) {
  const Export e = for_layers(asked);
  const uint32_t ranks = ranks_of(e);
  const double scale = metres(e.reader.meta().units, "OpenFOAM");
  if (e.has("--patches") && e.level != 0) throw UsageError(fmt::format("--patches: expected --level 0, whose cells have links, found {}", e.level));
  std::optional<LinkReader> links;
  if (e.has("--patches")) links.emplace(e.reader);
  Division division{e, cells_of_mesh(e), nullptr, {0, std::numeric_limits<int64_t>::max()}, links ? &*links : nullptr};
  const bool refined = e.has("--refine");
  expect_refined(e);
  if (!refined) expect_labels_for_cells(e, division, ranks);
  e.progress(0);
  CaseFolder folder(e.output, ranks, e.has("--ranks"));
  if (refined) write_refined(e, division, folder, ranks, scale);
  else write_equal(e, division, folder, ranks, scale);
  folder.commit();
  if (const auto other = e.has("--ranks") ? other_parts(e.output, ranks) : std::nullopt)
    e.tell(fmt::format("{}: system/decomposeParDict says numberOfSubdomains {}, and the mesh has {} parts: change it, or solvers refuse to start",
                       e.output.string(), *other, ranks));
  const std::vector<std::string> written = write_dictionaries(e.output, e.has("--ranks") ? std::optional(ranks) : std::nullopt);
  if (!written.empty())
    e.tell(fmt::format("{}: {} {} written for checkMesh and laplacianFoam, and yours to change", e.output.string(), fmt::join(written, ", "),
                       written.size() == 1 ? "is" : "are"));
}

}  // namespace
}  // namespace foam

ExportFormat openfoam_format() {
  return {.name = "openfoam",
          .extensions = {},
          .holds = "a mesh in the folder of an OpenFOAM case",
          .write = foam::write_case,
          .numbers = false,
          .options = refined_options({{"--fluid", "NAME,...", "the materials whose cells are the mesh; others are walls (default: the background)"},
                                      {"--patches", "", "walls are told apart by the patches of the surface (of a grid meshed with --links)"},
                                      {"--zones", "", "a cellZone for each material; without --fluid the cells of all materials are the mesh"},
                                      {"--drop-unreachable", "", "only the largest of the regions that don't touch through faces"},
                                      {"--ranks", "N", "parts of equally many cells, in processor0/ to processorN-1/"}})};
}

}  // namespace teracell::exports
