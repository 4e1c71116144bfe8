// The scene file (JSON): a grid, materials, bodies. Reading it checks everything that can be checked without opening
// a mesh; an unknown key is a UsageError that names it and the nearest known one.
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "store/grid.hpp"

namespace teracell {

enum class Fill { kAuto, kNonzero, kEvenodd };
enum class Closing { kCap, kStrict };

// p' = M p + t, each row ((m0 x + m1 y) + m2 z) + t, one rounding per operation. Row by row: m0 m1 m2 t.
using Matrix = std::array<double, 12>;
inline constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
Vec3 transform(const Matrix& m, const Vec3& p);

struct SceneMaterial {
  std::string name;
  std::string color;  // "#rrggbb" or "#rrggbbaa"
};

struct SceneBody {
  std::string name;
  std::filesystem::path mesh;  // resolved against the scene file's folder
  std::string mesh_text;       // as written in the scene: what the report shows
  std::string part;            // glob; empty takes all
  uint32_t material = 1;       // index into Scene::materials (0 is the background)
  int64_t priority = 0;
  Fill fill = Fill::kAuto;
  Closing closing = Closing::kCap;
  Matrix matrix = kIdentity;
};

// One axis of the domain as asked for; what is absent comes from the bodies' box.
struct SceneAxis {
  std::optional<double> min, max, step;
  std::optional<int64_t> cells;
  std::vector<double> planes;  // graded when not empty: nothing else is used then
};

struct Scene {
  std::string units = "m";
  std::array<SceneAxis, 3> axis;
  Vec3 sample = {0.5, 0.5, 0.5};
  int64_t pad = 1;
  std::optional<int64_t> longest_cells;  // --cells N: cubic cells, N on the longest axis with its pad
  std::vector<SceneMaterial> materials;  // [0] is the background
  std::vector<SceneBody> bodies;
  bool label_by_body = false;
};

// What the command line adds to bare meshes, or overrides in a scene where given.
struct GridOptions {
  std::optional<int64_t> longest_cells;       // --cells N
  std::optional<std::array<int64_t, 3>> cells;  // --cells NX,NY,NZ
  std::optional<double> step;                 // --step H
  std::optional<int64_t> pad;                 // --pad P
};

Scene read_scene(const std::filesystem::path& path);
Scene parse_scene(const std::string& json_text, const std::filesystem::path& folder);
// One body a file in the order given; material = file stem, numbered when repeated ("hull", "hull-2").
Scene bare_scene(const std::vector<std::filesystem::path>& meshes);
void override_grid(Scene& scene, const GridOptions& options);

// The scene as normalised: every default written out, matrices instead of scale/rotate/translate. Reads back equal.
nlohmann::ordered_json normalised(const Scene& scene);

// The axes (SPEC "From options to axes"). `lo`, `hi` are the box of all bodies' transformed vertices.
Grid resolve_grid(const Scene& scene, const Vec3& lo, const Vec3& hi);

}  // namespace teracell
