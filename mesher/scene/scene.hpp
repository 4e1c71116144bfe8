// The scene file (JSON): a grid, materials, bodies. Reading it checks everything that can be checked without opening
// a mesh; an unknown key is a UsageError that names it and the nearest known one.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "store/grid.hpp"

namespace teracell {

enum class Fill { kAuto, kNonzero, kEvenodd, kDistinct };
enum class Kind { kSolid, kSheet };
enum class Thin { kIgnore, kKeep };

// What happens to a surface that is still open after stitching.
struct Closing {
  enum class Way { kCap, kStrict, kExtrude };
  Way way = Way::kCap;
  int axis = 2;     // of the grid; of kExtrude
  bool up = false;  // towards greater coordinates; of kExtrude
  friend bool operator==(const Closing&, const Closing&) = default;
};

// p' = M p + t, each row ((m0 x + m1 y) + m2 z) + t, one rounding per operation. Row by row: m0 m1 m2 t.
using Matrix = std::array<double, 12>;
inline constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
Vec3 transform(const Matrix& m, const Vec3& p);

// Right-handed about an axis of any length but zero. Quarter turns have exact sines and cosines, so about a grid axis
// every entry is 0 or +-1; other angles use +, -, *, / and sqrt only: the same bits on every machine, unlike std::sin.
Matrix rotation(const Vec3& axis, double degrees);

struct SceneMaterial {
  std::string name;
  std::string color;  // "#rrggbb" or "#rrggbbaa", lower case
  friend bool operator==(const SceneMaterial&, const SceneMaterial&) = default;
};

struct SceneBody {
  std::string name;
  std::filesystem::path mesh;  // resolved against the scene file's folder
  std::string mesh_text;       // as written in the scene: what the report shows
  std::string part;            // glob; empty takes all
  uint32_t material = 1;       // index into Scene::materials (0 is the background)
  int64_t priority = 0;
  Fill fill = Fill::kAuto;
  Closing closing;
  std::optional<double> stitch;  // a length in the grid's units; absent: a quarter of the shortest cell edge; 0: none
  Kind kind = Kind::kSolid;
  Thin thin = Thin::kIgnore;
  Matrix matrix = kIdentity;
  friend bool operator==(const SceneBody&, const SceneBody&) = default;
};

// One axis of the domain as asked for; what is absent comes from the bodies' box.
struct SceneAxis {
  std::optional<double> min, max, step;  // min and max: both or neither
  std::optional<int64_t> cells;          // not with step
  std::vector<double> planes;            // graded when not empty: nothing else is used then
  std::filesystem::path planes_file;     // that the planes were read from; only so that nobody overwrites it
  friend bool operator==(const SceneAxis& a, const SceneAxis& b) {  // the same cells
    return a.min == b.min && a.max == b.max && a.step == b.step && a.cells == b.cells && a.planes == b.planes;
  }
};

struct Scene {
  std::string units = "m";
  std::array<SceneAxis, 3> axis;
  Vec3 sample = {0.5, 0.5, 0.5};
  int64_t pad = 1;
  // Cubic cells, this many on the longest axis with its pad: "cells": N in a scene's grid. An axis with
  // cells, step or planes of its own keeps them.
  std::optional<int64_t> longest_cells;
  std::vector<SceneMaterial> materials;  // [0] is the background
  std::vector<SceneBody> bodies;
  bool label_by_body = false;
  friend bool operator==(const Scene&, const Scene&) = default;
};

// What a caller adds to bare meshes, or overrides in a scene. At most one of the first three is given. Errors call the first two
// "cells", as scenes do.
struct GridOptions {
  std::optional<int64_t> longest_cells;
  std::optional<std::array<int64_t, 3>> cells;
  std::optional<double> step;
  std::optional<int64_t> pad;
};

// "cap", "strict" or "extrude:-z" (+ or -, x, y or z), as the command line has it. None when it is none of these.
std::optional<Closing> parse_closing(std::string_view text);

// A mesh need not exist yet. UsageError: the scene is wrong, with file, place, expected and found; IoError: the scene
// or its planes_file can't be read; InputError: the planes_file, with its line.
Scene read_scene(const std::filesystem::path& path);
Scene parse_scene(const std::string& json_text, const std::filesystem::path& folder);

// One body a file in the order given; material = file stem, numbered when repeated ("hull", "hull-2").
Scene bare_scene(const std::vector<std::filesystem::path>& meshes);

// The command line's cells or step replace the scene's on every uniform axis; its min and max stay. A graded axis keeps
// its planes: NX must agree with their number. An option that nothing in the scene leaves room for is a UsageError.
void override_grid(Scene& scene, const GridOptions& options);

// The scene as normalised: defaults written out, matrices instead of scale/rotate/translate; `stitch`, `kind` and `thin`
// only where they are not the default. Reads back equal. Bodies that `most` bytes don't hold are left out and counted.
std::string normalised(const Scene& scene, size_t most = ~size_t{0});

// The axes (how options become axes). `lo`, `hi` are the box of all bodies' transformed vertices; unused, and free
// to be anything, where every axis has min and max or planes. With e = hi - lo of an axis and P = pad:
//
//                  min and max given                       from the box
//   cells n        step = (max - min) / n                  step = e / (n - 2P), min = lo - P step; e = 0 is an error
//   step h         n = ceil((max - min) / h - 1e-9)        n = ceil(e / h - 1e-9) + 2P, min = lo - P h
//   cubic cells N  step = longest (max - min) / N,         step = longest e / (N - 2P), min = lo - P step,
//                  n = ceil((max - min) / step - 1e-9)     n = ceil(e / step) + 2P
//
// Each ceil is taken as at least 1, so a flat sheet gets one layer and its pad. The longest axis, and others exactly as
// long, get N without dividing back. With cubic cells on a domain given for some axes only, each axis counts by its own
// column and the widest step serves all. Nothing given for an axis is a UsageError.
Grid resolve_grid(const Scene& scene, const Vec3& lo, const Vec3& hi);

}  // namespace teracell
