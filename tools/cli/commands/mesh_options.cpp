#include "tools/cli/commands/mesh_options.hpp"

#include <strings.h>

#include <algorithm>

#include <fmt/format.h>

#include "mesher/bodies/caps_file.hpp"
#include "mesher/engines/engines.hpp"
#include "mesher/scene/from_parts.hpp"
#include "mesher/surface/read_facets.hpp"
#include "mesher/surface/units.hpp"
#include "store/base/error.hpp"
#include "store/base/output_file.hpp"
#include "store/base/system/system.hpp"

namespace teracell::cli {
namespace {

const std::vector<std::string> kFills(kFillNames.begin(), kFillNames.end());

// --shard I/N.
std::optional<mesher::Shard> parse_shard(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const size_t slash = text.find('/');
  if (slash == std::string::npos) throw UsageError(fmt::format("--shard: expected I/N, such as 0/8, found '{}'", text));
  constexpr int64_t kMost = 1'000'000;
  const int64_t of = parse_integer(text.substr(slash + 1), 1, kMost, "--shard, the number of parts");
  const int64_t number = parse_integer(text.substr(0, slash), 0, of - 1, "--shard, the number of the part");
  return mesher::Shard{static_cast<uint32_t>(number), static_cast<uint32_t>(of)};
}

}  // namespace

void add_mesh_options(CLI::App& app, MeshArguments& o, bool of_many) {
  app.add_option(
         "inputs", o.inputs,
         "a scene (.json), or surfaces: STL, OBJ, PLY, OFF, 3MF, glTF, STEP, plain or compressed by gzip; each is a body, and later ones win where they overlap")
      ->required();
  CLI::Option* output = app.add_option("-o,--output", o.output, "the .tcell file to write");
  if (of_many) output->required();
  app.add_option("--cells", o.cells,
                 "N: cubic cells, N along the longest axis with its pad, so fewer along the others; NX,NY,NZ: this many cells along each axis");
  app.add_flag("--by-part", o.by_part, "without a scene: a body and a material for each part of the files, not for each file");
  app.add_option("--units", o.units,
                 "of the grid, for surfaces without a scene: m, cm, mm, um, nm, in or ft (default: the first unit that a file states, else m); files "
                 "that state theirs are converted");
  app.add_option("--step", o.step, "the edge of a cell, in the units of the mesh");
  app.add_option("--pad", o.pad, "cells around the bodies' box (default 1)");
  app.add_option("--axis", o.axis, "the axis along which rays run: auto (the cheapest), x, y or z; the cells are the same")
      ->check(one_of({"auto", "x", "y", "z"}));
  app.add_option("--fill", o.fill, "the rule that says what is inside, for all solids: auto, nonzero, evenodd or distinct")->check(one_of(kFills));
  app.add_option(
      "--closing", o.closing,
      "what happens to solids whose surface is open after stitching: cap closes it, strict refuses it, extrude:-z (or +z, -x ...) extends it beyond the domain");
  app.add_option(
      "--stitch", o.stitch,
      "open edges of solids that are closer than this are joined; in the units of the grid (default: a quarter of the shortest cell edge; 0 joins none)");
  app.add_option("--deflection", o.deflection,
                 "of STEP files: the largest distance between a surface and its facets, in the units of the grid, or in cells, as 0.1c (default)")
      ->check([](const std::string& text) { return text.empty() ? "expected a length or cells, found nothing" : ""; });
  app.add_option("--angle", o.angle, "of STEP files: the largest angle between neighbouring chords, in degrees (default 12)")
      ->check(in_range(0.1, 90));
  app.add_flag("--face-patches", o.face_patches,
               "of STEP files: the faces of a part that have a colour of their own are patches, such as /as1/plate:red");
  add_cad_limits(app, o.cad);
  app.add_flag(
      "--thin", o.thin,
      "count, along x, y and z, the parts of every solid and of the gaps between solids that lie between sample points and are lost; the cells are the same");
  app.add_option(
         "--fractions", o.fractions,
         "SX,SY,SZ: keep in the file the shares of materials in cells that a boundary cuts, counted over this many sub-samples per cell along "
         "x, y and z: powers of two from 1 to 256, at most 65536 in all")
      ->check([](const std::string& text) { return text.empty() ? "expected SX,SY,SZ, found nothing" : ""; });
  app.add_flag("--links", o.links,
               "keep in the file where, between neighbouring cells with different labels, the one label ends and the other begins");
  app.add_option("--engine", o.engine, "how crossings are found: scan (the fastest), tree, slice or brute; the file is the same")
      ->check(one_of(mesher::engine_names()));
  add_threads(app, o.threads);
  if (of_many) app.get_option("--threads")->description("how many threads a rank has, 1 to 1024 (default: its share of the cores that it may use)");
  app.add_option("--memory", o.memory,
                 fmt::format("how much memory {}, such as 512M or 8G (default: {}a quarter of the machine's); surfaces that don't fit are spilled "
                             "to a temporary file",
                             of_many ? "a rank may take" : "the run may take", of_many ? "its share of " : ""));
  app.add_option("--tmp", o.tmp, "the folder for temporary files (default: the folder of the output)");
  app.add_flag("--resume", o.resume,
               "go on with what a killed run with the same inputs and options has left; if there is nothing, start from the beginning");
  if (!of_many)
    app.add_option("--shard", o.shard,
                   "I/N: make part I of 0 to N-1 alone, as OUTPUT.shard-I-of-N; `teracell merge` puts the parts together to the same bytes");
  app.add_option("--write-caps", o.caps,
                 "write the facets that close open surfaces: .stl, or .ply in double precision; one file per body when there are several");
  if (!of_many) app.add_flag("--dry-run", o.dry_run, "read the surfaces, say what the grid would be and about what it would take, and write no grid");
  if (!of_many)
    app.add_option("--write-planes", o.write_planes,
                   "write the planes of all axes into this folder: x.txt, y.txt, z.txt, a number a line, as \"planes_file\" reads them");
  if (!of_many) app.add_flag("--check", o.check, "look through the grid when it is done, as `teracell check` does");
  app.add_option("--report", o.report, "write the report, with times and memory, as JSON");
  add_progress(app, o.progress);
}

mesher::Scene scene_from(const MeshArguments& o) {
  bool json = false;
  for (const std::string& input : o.inputs) {
    const std::filesystem::path extension = std::filesystem::path(input).extension();
    if (extension == ".tcell") throw UsageError(fmt::format("{}: expected a scene or a surface, found a grid that is meshed already", input));
    json |= extension == ".json";
  }
  if (json && o.inputs.size() != 1)
    throw UsageError(fmt::format("expected one scene or bare meshes, found {} files with a scene among them", o.inputs.size()));
  if (json && o.by_part)
    throw UsageError("--by-part: expected surfaces without a scene, found a scene: `teracell scene` writes one with a body for each part");
  const std::vector<std::filesystem::path> files(o.inputs.begin(), o.inputs.end());
  mesher::Scene scene = json        ? mesher::read_scene(o.inputs[0])
                        : o.by_part ? mesher::scene_by_part(files, mesher::modest_budget(), o.cad.options())
                                    : mesher::bare_scene(files);
  if (!o.units.empty()) {
    if (json) throw UsageError("--units: expected surfaces without a scene, found a scene: its units are in the file");
    if (!mesher::is_unit(o.units)) throw UsageError(fmt::format("--units: expected m, cm, mm, um, nm, in or ft, found '{}'", o.units));
    scene.units = o.units;
  } else if (!json) {
    std::filesystem::path unsaid;
    scene.units = mesher::first_stated_unit(files, &unsaid);
    if (!unsaid.empty())
      warn(fmt::format("warning: {} states no unit: its coordinates are taken to be in {}, as another file states (a scene can scale it)",
                       unsaid.string(), scene.units));
  }
  if (!o.cells.empty() && o.step) throw UsageError("--cells and --step exclude each other: give one of them");
  mesher::GridOptions grid;
  if (!o.cells.empty()) {
    if (o.cells.find(',') == std::string::npos) grid.longest_cells = parse_integers(o.cells, 1, "--cells")[0];
    else {
      const auto n = parse_integers(o.cells, 3, "--cells");
      grid.cells = {n[0], n[1], n[2]};
    }
  }
  grid.step = o.step;
  grid.pad = o.pad;
  override_grid(scene, grid);
  const std::optional<mesher::Closing> closing = mesher::parse_closing(o.closing.empty() ? "cap" : o.closing);
  if (!closing) throw UsageError(fmt::format("--closing: expected cap, strict, or extrude: and a direction such as -z, found '{}'", o.closing));
  if (o.stitch && !(*o.stitch >= 0 && *o.stitch <= 1e75))
    throw UsageError(fmt::format("--stitch: expected a length from 0 to 1e75, found {}", *o.stitch));
  const std::optional<mesher::Deflection> deflection = mesher::parse_deflection(o.deflection.empty() ? "0.1c" : o.deflection);
  if (!deflection) throw UsageError(fmt::format("--deflection: expected a length above 0, or cells such as 0.1c, found '{}'", o.deflection));
  for (mesher::SceneBody& body : scene.bodies) {
    if (!o.deflection.empty()) body.deflection = *deflection;
    if (o.angle) body.angle = *o.angle;
    if (o.face_patches) body.face_patches = true;
  }
  const char* const for_solids = !o.fill.empty() ? "--fill" : !o.closing.empty() ? "--closing" : o.stitch ? "--stitch" : nullptr;
  if (for_solids && !scene.bodies.empty() &&
      std::ranges::all_of(scene.bodies, [](const mesher::SceneBody& body) { return body.kind == mesher::Kind::kSheet; }))
    throw UsageError(
        fmt::format("{}: expected a scene with solids, found sheets only, which are not filled, closed or stitched: leave it out", for_solids));
  for (mesher::SceneBody& body : scene.bodies) {
    if (body.kind == mesher::Kind::kSheet) continue;
    if (!o.fill.empty()) body.fill = static_cast<Fill>(std::ranges::find(kFills, o.fill) - kFills.begin());
    if (!o.closing.empty()) body.closing = *closing;
    if (o.stitch) body.stitch = o.stitch;
  }
  return scene;
}

void check_planes(const MeshArguments& o, const mesher::Scene& scene) {
  if (o.write_planes.empty()) return;
  std::error_code none;
  for (int d = 0; d < 3; ++d)
    for (const mesher::SceneAxis& axis : scene.axis)
      if (std::filesystem::equivalent(axis.planes_file, mesher::planes_path(o.write_planes, d), none))
        throw UsageError(
            fmt::format("--write-planes: expected another folder, found one whose {} the scene reads", axis.planes_file.filename().string()));
}

void check_outputs(const MeshArguments& o, const mesher::Scene& scene) {
  if (o.output.empty()) throw UsageError("--output: expected the name of the .tcell file to write, found none");
  for (const char* other : {".json", ".stl", ".obj", ".ply", ".step", ".stp", ".gz", ".png", ".npy"})  // surely a slip
    if (strcasecmp(std::filesystem::path(o.output).extension().c_str(), other) == 0)
      throw UsageError(fmt::format("--output: expected a name for a .tcell file, found '{}'", o.output));
  expect_file_name(o.output);
  std::error_code none;
  if (!o.report.empty() && (o.report == o.output || o.report == o.output + ".partial" || std::filesystem::equivalent(o.report, o.output, none)))
    throw UsageError(fmt::format("--report and --output name the same file, {}", o.output));
  std::vector<std::string> outputs = {o.output, o.report};
  if (!o.caps.empty())
    for (const auto& name : caps_names(scene, o.caps)) outputs.push_back(name.string());
  for (size_t i = 2; i < outputs.size(); ++i)
    if (outputs[i] == o.output || outputs[i] == o.report)
      throw UsageError(fmt::format("--write-caps: expected a name of its own, found {}", outputs[i]));
  std::vector<std::string> inputs = o.inputs;
  for (const mesher::SceneBody& body : scene.bodies) inputs.push_back(body.mesh.string());
  for (const mesher::SceneAxis& axis : scene.axis) inputs.push_back(axis.planes_file.string());
  refuse_overwriting(inputs, o.output);  // of what was left of this one, warn_of_leftovers() knows more
  for (size_t i = 1; i < outputs.size(); ++i) check_output(inputs, outputs[i]);
  check_planes(o, scene);
}

mesher::MeshOptions mesh_options(const MeshArguments& o, int share) {
  mesher::MeshOptions options;
  if (o.axis != "auto") options.axis = parse_axis(o.axis);
  options.engine = o.engine;
  options.threads = o.threads;
  options.memory = o.memory.empty() ? system::memory() / 4 / static_cast<uint64_t>(share) : parse_size(o.memory, "--memory");
  if (!o.tmp.empty() && !std::filesystem::is_directory(o.tmp))
    throw IoError(
        fmt::format("{}: no folder for temporary files: {}", o.tmp, std::filesystem::exists(o.tmp) ? "Not a directory" : "No such file or directory"),
        Remedy::kOtherFolder);
  if (options.memory == 0) throw UsageError("--memory: expected a size like 512M or 8G, found 0");
  options.tmp = o.tmp;
  options.cad = o.cad.options();
  options.write_caps = o.caps;
  options.resume = o.resume;
  options.thin = o.thin;
  options.links = o.links;
  options.shard = parse_shard(o.shard);
  if (!o.fractions.empty()) {
    const auto n = parse_integers(o.fractions, 3, "--fractions");
    Subdivision samples;
    for (size_t d = 0; d < 3; ++d) {
      if (n[d] < 1 || n[d] > 256) throw UsageError(fmt::format("--fractions: expected powers of two from 1 to 256, found {}", n[d]));
      samples[d] = static_cast<uint32_t>(n[d]);
    }
    if (const std::string beyond = beyond_bounds(samples); !beyond.empty()) throw UsageError("--fractions: " + beyond);
    options.fractions = samples;
  }
  return options;
}

void warn_of_leftovers(const MeshArguments& o, const std::filesystem::path& file) {
  const bool could_resume = std::filesystem::exists(file.string() + ".resume");
  if (!left_behind(file) || (o.resume && could_resume)) return;
  warn(fmt::format("warning: {}.partial will be thrown away when the grid is begun: a killed run has left it{}", file.string(),
                   o.resume       ? fmt::format(", but no {}.resume to go on from", file.string())
                   : could_resume ? ", and --resume would go on with it"
                                  : ""));
}

void warn_of_caps(const MeshArguments& o, const mesher::MeshReport& report) {
  if (!o.caps.empty() && report.caps_written == 0) warn(fmt::format("warning: --write-caps: no surface was open, so {} was not written", o.caps));
}

}  // namespace teracell::cli
