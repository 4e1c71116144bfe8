// The scene file (JSON): a grid, materials and bodies. Reading it checks everything that can be checked without opening a
// mesh. An unknown key is a UsageError that names it and the nearest known key.
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mesher/scene/auto_planes.hpp"
#include "mesher/surface/matrix.hpp"
#include "store/grid/report.hpp"

namespace teracell::mesher {

enum class Kind { kSolid, kSheet };
enum class Thin { kIgnore, kKeep };

// What happens to a surface that is still open after stitching.
struct Closing {
  enum class Way { kCap, kStrict, kExtrude };
  Way way = Way::kCap;
  int axis = 2;     // of the grid; for kExtrude
  bool up = false;  // towards greater coordinates; for kExtrude
  friend bool operator==(const Closing&, const Closing&) = default;
};

// A right-handed rotation about an axis of any length but zero. Quarter turns have exact sines and cosines, so about an axis
// of the grid their entries are 0, 1 and -1. Other angles use only +, -, *, / and sqrt, which give the same bits on every
// machine; std::sin does not.
Matrix rotation(const Vec3& axis, double degrees);

struct SceneMaterial {
  std::string name;
  std::string color;  // "#rrggbb" or "#rrggbbaa", lower case
  friend bool operator==(const SceneMaterial&, const SceneMaterial&) = default;
};

// The largest distance between an exact surface and its facets.
struct Deflection {
  double value = 0.1;
  bool in_cells = true;  // times the shortest cell edge; else a length in the grid's units
  friend bool operator==(const Deflection&, const Deflection&) = default;
};

struct SceneBody {
  std::string name;
  std::filesystem::path mesh;  // resolved against the scene file's folder
  std::string mesh_text;       // what the report shows: mesh_shown()
  std::string part;            // a glob; empty: all parts
  uint32_t material = 1;       // index into Scene::materials (0 is the background)
  int64_t priority = 0;
  Fill fill = Fill::kAuto;
  Closing closing;
  std::optional<double> stitch;  // a length in the grid's units; absent: a quarter of the shortest cell edge; 0: no stitching
  Kind kind = Kind::kSolid;
  Thin thin = Thin::kIgnore;
  Matrix matrix = kIdentity;
  Deflection deflection;  // of exact surfaces, as STEP files have them; and the angle between neighbouring chords, in degrees
  double angle = 12;
  bool patches = true;  // groups, objects and solids of the mesh are patches of their own
  bool face_patches = false;  // so are faces of a part that have a colour of their own
  friend bool operator==(const SceneBody&, const SceneBody&) = default;
};

// One axis of the domain as the scene describes it. What is absent follows from the bodies' box.
struct SceneAxis {
  std::optional<double> min, max, step;  // min and max: both or neither
  std::optional<int64_t> cells;          // not with step
  std::vector<double> planes;            // not empty: the axis is graded, and the members above are not used
  std::filesystem::path planes_file;     // from which the planes were read: no output may overwrite it
  std::optional<AutoPlanes> made;        // how its planes are made; then there are no cells, step and planes
  friend bool operator==(const SceneAxis& a, const SceneAxis& b) {  // the same cells
    return a.min == b.min && a.max == b.max && a.step == b.step && a.cells == b.cells && a.planes == b.planes && a.made == b.made;
  }
};

// What a label stands for: a material; a body; or what of a body lies in no other one, and what lies in others as well.
enum class LabelBy { kMaterial, kBody, kOverlap };
inline constexpr std::array<std::string_view, 3> kLabelByNames = {"material", "body", "overlap"};  // in the order of LabelBy

struct Scene {
  std::string units = "m";
  std::array<SceneAxis, 3> axis;
  Vec3 sample = {0.5, 0.5, 0.5};
  int64_t pad = 1;
  // Cubic cells, this many on the longest axis including its pad: "cells": N in a scene's grid. An axis that has cells, a step or
  // planes of its own keeps them.
  std::optional<int64_t> longest_cells;
  std::vector<SceneMaterial> materials;  // [0] is the background
  std::vector<SceneBody> bodies;
  LabelBy label_by = LabelBy::kMaterial;
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

// The closing for "cap", "strict" or "extrude:-z" (+ or -, then x, y or z); empty for any other text.
std::optional<Closing> parse_closing(std::string_view text);

inline bool is_chord_angle(double degrees) { return degrees >= 0.1 && degrees <= 90; }
// A length ("0.05") or a number of cells ("0.1c"); empty for any other text.
std::optional<Deflection> parse_deflection(std::string_view text);

// The meshes need not exist yet. Throws UsageError when the scene is wrong (file, place, expected, found), IoError when the
// scene or its planes_file can't be read, and InputError, with the line, when the planes_file is wrong.
Scene read_scene(const std::filesystem::path& path);
Scene parse_scene(const std::string& json_text, const std::filesystem::path& folder);

// A mesh as others may see it: as the scene names it, but of an absolute path what comes after the scene's folder, or the file's name alone.
std::string mesh_shown(const std::filesystem::path& mesh, const std::filesystem::path& folder);
// The same without a scene: of an absolute path the file's name alone, wherever the program runs.
std::string bare_mesh_shown(const std::filesystem::path& mesh);

// One body per file, in the order given: shown by its path, or of an absolute one by the file's name alone. Body and material are named after the
// file, with a number when the name repeats ("hull", "hull-2").
Scene bare_scene(const std::vector<std::filesystem::path>& meshes);

// The cells or step given in the options replace those of every uniform axis, whose min and max stay. A graded axis keeps its
// planes, and NX must agree with their number. An option that can have no effect on the scene is a UsageError.
void override_grid(Scene& scene, const GridOptions& options);

// The scene as JSON in a normal form: defaults are written out, and a matrix takes the place of scale, rotate and translate.
// `stitch`, `kind`, `thin`, `deflection`, `angle`, `face_patches` and `patches` are written only where they are not the default. Parsing the text
// gives an equal scene, whose meshes are as mesh_shown() names them. Bodies that don't fit into `most` bytes are left out, and
// their number is written instead.
std::string normalised(const Scene& scene, size_t most = ~size_t{0});

// Resolves the scene's axes. `lo` and `hi` are the box of all bodies' transformed vertices; they are not used, and may hold
// anything, when every axis has planes or min and max. For an axis with e = hi - lo and P = pad:
//
//                  min and max given                       from the box
//   cells n        step = (max - min) / n                  step = e / (n - 2P), min = lo - P step; e = 0 is an error
//   step h         n = ceil((max - min) / h - 1e-9)        n = ceil(e / h - 1e-9) + 2P, min = lo - P h
//   cubic cells N  step = longest (max - min) / N,         step = longest e / (N - 2P), min = lo - P step,
//                  n = ceil((max - min) / step - 1e-9)     n = ceil(e / step) + 2P
//
// Each ceil counts as at least 1, so a flat sheet gets one layer of cells and its pad. The longest axis, and every axis of
// exactly the same length, gets N itself and not a quotient. With cubic cells and a domain that is given for some axes only,
// the step of each axis follows from its own column of the table, and the widest of these steps is used for all. An axis
// for which neither cells nor step is given is a UsageError.
// `made`: planes of the axes that the scene has made (SceneAxis::made).
Grid resolve_grid(const Scene& scene, const Vec3& lo, const Vec3& hi, const std::array<std::vector<double>, 3>& made = {});

}  // namespace teracell::mesher
