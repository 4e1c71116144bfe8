#include "mesher/scene/scene.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "mesher/scene/names.hpp"
#include "store/base/error.hpp"
#include "store/text/color.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

// {sine, cosine} by Taylor series on [-45, 45] degrees, where the first omitted term is below 1e-19.
std::array<double, 2> sine_cosine(double degrees) {
  const double turn = std::fmod(degrees, 360);   // exact
  const double rest = std::remainder(turn, 90);  // exact
  const auto quarter = std::lround((turn - rest) / 90) & 3;
  const double x = rest * 0.017453292519943295, xx = x * x;
  double s = 1, c = 1;
  for (int k = 18; k >= 2; k -= 2) {
    s = 1 - xx / (k * (k + 1)) * s;
    c = 1 - xx / (k * (k - 1)) * c;
  }
  s *= x;
  switch (quarter) {
    case 0: return {s, c};
    case 1: return {c, -s};
    case 2: return {-s, -c};
    default: return {-c, s};
  }
}

int64_t checked_count(double cells) {
  if (!(cells <= static_cast<double>(Axis::kMaxCells)))
    throw UsageError(fmt::format("an axis has at most {} cells, found {}: take a larger step or fewer cells", Axis::kMaxCells, cells));
  return static_cast<int64_t>(cells);
}

// ceil(extent / step - slack), but at least one layer.
int64_t layers(double extent, double step, double slack) { return checked_count(std::max(1.0, std::ceil(extent / step - slack))); }

// The cells of an axis without its pads.
int64_t without_pad(int64_t cells, int64_t pad) {
  if (cells <= 2 * pad)
    throw UsageError(
        fmt::format("{} cells leave none between the pads of {} on either side: give at least {} cells or a smaller pad", cells, pad, 2 * pad + 1));
  return cells - 2 * pad;
}

// What an axis has to cover: its own min and max, or the bodies' box with the pad around it.
struct Span {
  double min = 0, extent = 0;
  int64_t pad = 0;
  bool slack = false;  // a step that divides max - min, but for rounding, adds no cell
};

Span span_of(const SceneAxis& axis, int64_t pad, double lo, double hi) {
  if (axis.min) return {*axis.min, *axis.max - *axis.min, 0, true};
  if (!(lo <= hi)) throw InputError("the grid has no min and max, and there are no facets to take them from: give it \"min\" and \"max\", or bodies");
  return {lo, hi - lo, pad, false};
}

// Cubic cells: the step that puts longest_cells on the longest span. Every span with this step and extent gets that number.
struct Cubic {
  double step = 0, extent = 0;
  bool longest(double a_step, double an_extent) const { return a_step == step && an_extent == extent; }
};

bool is_cubic(const SceneAxis& axis) { return axis.planes.empty() && !axis.cells && !axis.step && !axis.made; }

Cubic cubic_cells(const Scene& scene, const Vec3& lo, const Vec3& hi) {
  Cubic best;
  for (int a = 0; a < 3; ++a) {
    if (!is_cubic(scene.axis[a])) continue;
    const Span span = span_of(scene.axis[a], scene.pad, lo[a], hi[a]);
    const double step = span.extent / static_cast<double>(without_pad(*scene.longest_cells, span.pad));
    if (std::tie(step, span.extent) > std::tie(best.step, best.extent)) best = {step, span.extent};
  }
  if (!(best.step > 0)) throw UsageError("the bodies' box has no extent, so a number of cells gives no step: give a step or the grid's min and max");
  return best;
}

Axis resolve_axis(const Scene& scene, int a, double lo, double hi, const Cubic& cubic, const std::vector<double>& made) {
  const SceneAxis& axis = scene.axis[a];
  if (axis.made) return Axis::graded(made, scene.sample[a]);
  if (!axis.planes.empty()) return Axis::graded(axis.planes, scene.sample[a]);
  if (!axis.cells && !axis.step && !scene.longest_cells) throw UsageError("neither a number of cells nor a step is given", Remedy::kCellsOrStep);

  const Span span = span_of(axis, scene.pad, lo, hi);
  const double slack = span.slack ? 1e-9 : 0;
  double step = 0;
  int64_t cells = 0;
  if (axis.cells) {
    cells = *axis.cells;
    step = span.extent / static_cast<double>(without_pad(cells, span.pad));
    if (span.extent == 0) throw UsageError("the bodies' box has no extent here, so a number of cells gives no step: give a step, or min and max");
  } else if (axis.step) {
    step = *axis.step;
    cells = checked_count(static_cast<double>(layers(span.extent, step, 1e-9)) + 2 * static_cast<double>(span.pad));
  } else {
    step = cubic.step;
    const double own = span.extent / static_cast<double>(without_pad(*scene.longest_cells, span.pad));
    cells = cubic.longest(own, span.extent)
                ? *scene.longest_cells
                : checked_count(static_cast<double>(layers(span.extent, step, slack)) + 2 * static_cast<double>(span.pad));
  }
  return Axis::uniform(span.min - static_cast<double>(span.pad) * step, step, 0, cells, scene.sample[a]);
}

void check_options(const GridOptions& o) {
  const int ways = o.longest_cells.has_value() + o.cells.has_value() + o.step.has_value();
  if (ways > 1) throw UsageError("cells and step exclude each other: give one of them");
  auto check_cells = [](int64_t n) {
    if (n < 1 || n > Axis::kMaxCells) throw OptionError(fmt::format("cells: expected 1 to {}, found {}", Axis::kMaxCells, n));
  };
  if (o.longest_cells) check_cells(*o.longest_cells);
  if (o.cells) std::for_each(o.cells->begin(), o.cells->end(), check_cells);
  if (o.step && !(*o.step > 0 && std::isfinite(*o.step))) throw OptionError(fmt::format("step: expected a number above 0, found {}", *o.step));
  if (o.pad && (*o.pad < 0 || *o.pad > kMaxPad)) throw OptionError(fmt::format("pad: expected 0 to {}, found {}", kMaxPad, *o.pad));
}

}  // namespace

Matrix rotation(const Vec3& axis, double degrees) {
  // k is the unit vector. Dividing by the largest component first makes it exact along a grid axis and avoids overflow.
  const double largest = std::max({std::abs(axis[0]), std::abs(axis[1]), std::abs(axis[2])});
  Vec3 k = {axis[0] / largest, axis[1] / largest, axis[2] / largest};
  const double length = std::sqrt(k[0] * k[0] + k[1] * k[1] + k[2] * k[2]);
  for (double& x : k) x /= length;
  const auto [s, c] = sine_cosine(degrees);
  // Rodrigues' formula as R = k k' + c (I - k k') + s [k]x: with k exactly along a grid axis, that axis stays exactly as it is.
  const Vec3 cross[3] = {{0, -k[2], k[1]}, {k[2], 0, -k[0]}, {-k[1], k[0], 0}};
  Matrix m = kIdentity;
  for (int row = 0; row < 3; ++row)
    for (int col = 0; col < 3; ++col) {
      const double kk = k[row] * k[col], along = row == col ? 1 - kk : -kk;
      m[4 * row + col] = (kk + c * along) + s * cross[row][col] + 0.0;  // -0 becomes 0
    }
  return m;
}

std::string mesh_shown(const std::filesystem::path& mesh, const std::filesystem::path& folder) {
  if (!mesh.is_absolute()) return mesh.string();
  const std::filesystem::path home = std::filesystem::absolute(folder.empty() ? "." : folder);
  const std::filesystem::path within = mesh.lexically_normal().lexically_relative(home.lexically_normal());
  if (!within.empty() && *within.begin() != "..") return within.string();
  return mesh.has_filename() ? mesh.filename().string() : ".";  // as the folder that it names; a scene's mesh is not empty
}

std::string bare_mesh_shown(const std::filesystem::path& mesh) { return printable((mesh.is_absolute() ? mesh.filename() : mesh).string()); }

Scene bare_scene(const std::vector<std::filesystem::path>& meshes) {
  if (meshes.size() > kMaxMaterials)
    throw UsageError(
        fmt::format("expected at most {} meshes, each with a material of its own, found {}: write a scene file, where they can share materials",
                    kMaxMaterials, meshes.size()));
  Scene scene;
  scene.materials.push_back({"air", kBackgroundColor});
  NameBook names;
  names.take("air");
  for (const std::filesystem::path& path : meshes) {
    const auto id = static_cast<uint32_t>(scene.materials.size());
    SceneBody body;
    body.name = names.numbered(mesh_stem(path));
    body.mesh = path;
    body.mesh_text = bare_mesh_shown(path);
    body.material = id;
    scene.materials.push_back({body.name, palette_color(id)});
    scene.bodies.push_back(std::move(body));
  }
  return scene;
}

void override_grid(Scene& scene, const GridOptions& options) {
  check_options(options);
  if (options.pad) {
    const auto fixed = [](const SceneAxis& axis) { return axis.min || !axis.planes.empty() || axis.made; };
    if (std::all_of(scene.axis.begin(), scene.axis.end(), fixed))
      throw OptionError(
          "pad: the scene fixes where every axis begins and ends, or has a pad of its own (\"auto\"), so there is no bodies' box to pad: leave it out");
    scene.pad = *options.pad;
  }
  if (!options.longest_cells && !options.cells && !options.step) return;
  const auto made = [](const SceneAxis& axis) { return axis.made.has_value(); };
  if (std::ranges::all_of(scene.axis, made) || (options.cells && std::ranges::any_of(scene.axis, made)))
    throw OptionError(fmt::format("{}: the scene has its planes made (\"auto\"), which excludes cells and step", options.step ? "step" : "cells"));

  scene.longest_cells = options.longest_cells;
  int graded = 0;
  for (int a = 0; a < 3; ++a) {
    SceneAxis& axis = scene.axis[a];
    if (axis.made) continue;
    if (axis.planes.empty()) {
      axis.cells = options.cells ? std::optional((*options.cells)[a]) : std::nullopt;
      axis.step = options.step;
      continue;
    }
    ++graded;
    const auto cells = static_cast<int64_t>(axis.planes.size()) - 1;
    if (options.cells && (*options.cells)[a] != cells)
      throw OptionError(
          fmt::format("cells: axis {} has {} cells between the planes of the scene, found {}", axis_name(a), cells, (*options.cells)[a]));
  }
  if (graded == 3 && !options.cells)
    throw OptionError(fmt::format("{}: the scene gives planes for all three axes, so there is nothing to override", options.step ? "step" : "cells"));
}

Grid resolve_grid(const Scene& scene, const Vec3& lo, const Vec3& hi, const std::array<std::vector<double>, 3>& made) {
  const bool cubic_wanted = scene.longest_cells && std::any_of(scene.axis.begin(), scene.axis.end(), is_cubic);
  const Cubic cubic = cubic_wanted ? cubic_cells(scene, lo, hi) : Cubic{};
  Grid grid;
  for (int a = 0; a < 3; ++a) {
    try {
      grid.axis[a] = resolve_axis(scene, a, lo[a], hi[a], cubic, made[a]);
    } catch (const UsageError& e) {
      throw UsageError(fmt::format("axis {} of the grid: {}", axis_name(a), e.what()), e.remedy);
    }
  }
  return grid;
}

}  // namespace teracell::mesher
