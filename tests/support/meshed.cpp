#include "tests/support/meshed.hpp"

#include "mesher/report/report_json.hpp"
#include "tests/support/stored.hpp"

namespace teracell::testing {

TempFolder::TempFolder() {
  std::string name = (std::filesystem::temp_directory_path() / "teracell-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
  path_ = name;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

mesher::Scene scene_of(const TempFolder& folder, const std::vector<oracle::Body>& bodies, const Grid& grid) {
  mesher::Scene scene;
  for (int d = 0; d < 3; ++d) {
    const Axis& a = grid.axis[d];
    scene.sample[d] = a.sample();
    if (a.is_graded()) scene.axis[d].planes = a.planes();
    else {
      scene.axis[d].min = a.min();
      scene.axis[d].max = a.max();
      scene.axis[d].cells = a.cells();
    }
  }
  uint32_t materials = 0;
  for (const oracle::Body& b : bodies) materials = std::max(materials, b.material);
  for (uint32_t m = 0; m <= materials; ++m) scene.materials.push_back({fmt::format("m{}", m), "#808080"});
  for (size_t i = 0; i < bodies.size(); ++i) {
    const std::string name = fmt::format("body{}", i);
    shapes::write_obj(folder / (name + ".obj"), bodies[i].facets);
    mesher::SceneBody body;
    body.name = name;
    body.mesh = folder / (name + ".obj");
    body.mesh_text = name + ".obj";
    body.material = bodies[i].material;
    body.priority = bodies[i].priority;
    body.fill = bodies[i].rule == oracle::Rule::kEvenodd ? Fill::kEvenodd : Fill::kNonzero;
    if (bodies[i].sheet) body.kind = mesher::Kind::kSheet, body.fill = Fill::kAuto;
    scene.bodies.push_back(body);
  }
  return scene;
}

nlohmann::ordered_json mesh_quietly(const mesher::Scene& scene, const std::filesystem::path& output, const mesher::MeshOptions& options) {
  const std::atomic<bool> stop{false};
  const mesher::MeshReport found = mesh(
      scene, output, options, [](const char*, double, double) {}, stop);
  return nlohmann::ordered_json::parse(report_json(found.report, scene, found.run, found.warnings()));
}

GridReader meshed_reader(const std::vector<oracle::Body>& bodies, const Grid& grid, const mesher::MeshOptions& options) {
  const TempFolder folder;
  mesh_quietly(scene_of(folder, bodies, grid), folder / "g.tcell", options);
  return reader_of(file_bytes(folder / "g.tcell"));
}

std::vector<uint32_t> all_cells(const GridReader& reader, int level) {
  const Index3 n = reader.meta().grid.cells(level);
  std::vector<uint32_t> cells(static_cast<size_t>(n[0] * n[1] * n[2]));
  read_box<uint32_t>(reader, level, reader.meta().grid.box(level), strongest_material(reader.meta()), 0, cells.data(), {1, n[0], n[0] * n[1]});
  return cells;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace teracell::testing
