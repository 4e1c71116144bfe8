#include "tools/export/openfoam/mesh_files.hpp"

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::exports::foam {
namespace {

// A file whose lists are filled later.
class ListFile {
 public:
  ListFile(const std::filesystem::path& folder, const std::string& name, const std::string& kind, bool binary, const std::string& note = "")
      : file_(std::make_shared<std::filesystem::path>(folder / name)) {
    text(fmt::format("FoamFile\n{{\n    version     2.0;\n    format      {};\n    class       {};\n", binary ? "binary" : "ascii", kind));
    if (binary) text("    arch        \"LSB;label=32;scalar=64\";\n");
    if (!note.empty()) text(fmt::format("    note        \"{}\";\n", note));
    text(fmt::format("    location    \"constant/polyMesh\";\n    object      {};\n}}\n\n", name));
  }
  void text(const std::string& t) {
    write_at(*file_, size_, {reinterpret_cast<const uint8_t*>(t.data()), t.size()});
    size_ += t.size();
  }
  // Leaves room for a list, and returns where its content begins. A binary list without content has no parentheses.
  Place list(int64_t count, size_t bytes_each) {
    text(fmt::format("{}\n{}", count, count > 0 ? "(" : ""));
    Place begin{file_, size_};
    size_ += static_cast<uint64_t>(count) * bytes_each;
    text(count > 0 ? ")\n" : "");
    return begin;
  }

 private:
  const std::shared_ptr<const std::filesystem::path> file_;
  uint64_t size_ = 0;
};

std::string boundary_text(uint32_t part, const PartCounts& counts, const MeshNames& names, std::vector<int32_t>& address) {
  std::string text;
  int64_t start = 0, patches = 0;
  const auto patch = [&](const std::string& name, const std::string& type, int64_t faces, const std::string& more, int32_t in_whole) {
    text += fmt::format("    {}\n    {{\n        type            {};\n{}        nFaces          {};\n        startFace       {};\n    }}\n", name,
                        type, more, faces, start);
    start += faces;
    ++patches;
    address.push_back(in_whole);
  };
  const auto faces_of = [&](FaceGroup g) {
    const auto it = counts.faces.find(g);
    return it == counts.faces.end() ? 0 : it->second;
  };
  start = faces_of(kInner);
  for (const auto& [what, info] : names.patches) patch(info.name, info.type, faces_of(what), "", static_cast<int32_t>(patches));
  for (auto it = counts.faces.lower_bound(kShared); it != counts.faces.end(); ++it) {
    const auto other = static_cast<uint32_t>(it->first - kShared);
    patch(fmt::format("procBoundary{}to{}", part, other), "processor", it->second,
          fmt::format("        inGroups        1(processor);\n        matchTolerance  0.0001;\n        transform       unknown;\n"
                      "        myProcNo        {};\n        neighbProcNo    {};\n",
                      part, other),
          -1);
  }
  return fmt::format("{}\n(\n{})\n", patches, text);
}

}  // namespace

MeshFiles::MeshFiles(const std::filesystem::path& folder, uint32_t part, const PartCounts& counts, const MeshNames& names, Streams& streams) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw IoError(fmt::format("{}: can't create: {}", folder.string(), error.message()));
  const int64_t faces = counts.all_faces();
  const auto inner = counts.faces.find(kInner);
  const int64_t inner_faces = inner == counts.faces.end() ? 0 : inner->second;
  const auto single_list = [&](std::optional<Stream>& stream, const char* name, const char* kind, int64_t count, size_t bytes_each,
                               const std::string& note = "") {
    ListFile file(folder, name, kind, true, note);
    stream.emplace(streams, file.list(count, bytes_each));
  };
  const std::string note = fmt::format("nPoints:{}  nCells:{}  nFaces:{}  nInternalFaces:{}", counts.points, counts.cells, faces, inner_faces);
  single_list(points, "points", "vectorField", counts.points, 3 * sizeof(double));
  single_list(neighbour, "neighbour", "labelList", inner_faces, sizeof(int32_t), note);

  ListFile face_file(folder, "faces", "faceCompactList", true);
  const int64_t corners = counts.all_corners();
  Place begins_at = face_file.list(faces + 1, sizeof(int32_t));  // where each face begins in the list of all corners
  if (counts.corners.empty()) {
    Stream begins(streams, begins_at);
    for (int64_t i = 0; i <= faces; ++i) begins.put(static_cast<int32_t>(4 * i));
    begins.close();
  } else {
    Stream end(streams, {begins_at.file, begins_at.at + static_cast<uint64_t>(faces) * sizeof(int32_t)});
    end.put(static_cast<int32_t>(corners));
    end.close();
  }
  Place faces_at = face_file.list(corners, sizeof(int32_t));
  ListFile owner_file(folder, "owner", "labelList", true, note);
  Place owner_at = owner_file.list(faces, sizeof(int32_t));
  std::optional<Place> address_at;
  std::vector<int32_t> patch_address;
  ListFile(folder, "boundary", "polyBoundaryMesh", false).text(boundary_text(part, counts, names, patch_address));
  if (names.addressing) {
    single_list(point_address, "pointProcAddressing", "labelList", counts.points, sizeof(int32_t));
    single_list(cell_address, "cellProcAddressing", "labelList", counts.cells, sizeof(int32_t));
    std::optional<Stream> patch_stream;
    single_list(patch_stream, "boundaryProcAddressing", "labelList", static_cast<int64_t>(patch_address.size()), sizeof(int32_t));
    for (const int32_t p : patch_address) patch_stream->put(p);
    patch_stream->close();
    address_at = ListFile(folder, "faceProcAddressing", "labelList", true).list(faces, sizeof(int32_t));
  }
  if (names.refined_from) {
    single_list(cell_level, "cellLevel", "labelList", counts.cells, sizeof(int32_t));
    single_list(point_level, "pointLevel", "labelList", counts.points, sizeof(int32_t));
    if (*names.refined_from > 0)
      ListFile(folder, "level0Edge", "uniformDimensionedScalarField", false)
          .text(fmt::format("dimensions      [0 1 0 0 0 0 0];\n\nvalue           {};\n", *names.refined_from));
  }
  int64_t corner = 0;
  for (const auto& [g, count] : counts.faces) {
    Group& group = groups_.try_emplace(g, streams, faces_at, owner_at).first->second;
    group.corners = corner;
    corner += counts.corners_of(g);
    if (!counts.corners.empty()) group.begins.emplace(streams, begins_at);
    begins_at.at += static_cast<uint64_t>(count) * sizeof(int32_t);
    faces_at.at += static_cast<uint64_t>(counts.corners_of(g)) * sizeof(int32_t);
    owner_at.at += static_cast<uint64_t>(count) * sizeof(int32_t);
    if (!address_at) continue;
    group.address.emplace(streams, *address_at);
    address_at->at += static_cast<uint64_t>(count) * sizeof(int32_t);
  }

  if (names.zones.empty()) return;
  ListFile zone_file(folder, "cellZones", "regIOobject", true);
  zone_file.text(fmt::format("{}\n(\n", names.zones.size()));
  for (const auto& [material, name] : names.zones) {
    zone_file.text(fmt::format("{}\n{{\n    type cellZone;\ncellLabels      List<label> \n", name));
    const auto it = counts.zones.find(material);
    zones_.try_emplace(material, streams, zone_file.list(it == counts.zones.end() ? 0 : it->second, sizeof(int32_t)));
    zone_file.text(";\n}\n\n");
  }
  zone_file.text(")\n");
}

void MeshFiles::close() {
  for (std::optional<Stream>* stream : {&points, &neighbour, &point_address, &cell_address, &cell_level, &point_level})
    if (*stream) (*stream)->close();
  for (auto& [g, group] : groups_) {
    group.faces.close(), group.owner.close();
    for (std::optional<Stream>* stream : {&group.begins, &group.address})
      if (*stream) (*stream)->close();
  }
  for (auto& [material, zone] : zones_) zone.close();
}

}  // namespace teracell::exports::foam
