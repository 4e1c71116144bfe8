// The options of meshing, which the program of one process and that of many share.
#pragma once
#include "mesher/pipeline.hpp"
#include "mesher/run/planes_files.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {

struct MeshArguments {
  std::vector<std::string> inputs;
  std::string output, cells, axis = "auto", fill, closing, engine = "scan", memory, tmp, caps, report, shard, fractions, units, write_planes,
                             progress = "auto";
  std::string deflection;
  std::optional<double> step, stitch, angle;
  CadArguments cad;
  std::optional<int64_t> pad;
  int threads = 0;
  bool resume = false, thin = false, links = false, check = false, by_part = false, face_patches = false, dry_run = false;
};

// `of_many`: of a program of many processes, which takes no part of the grid.
void add_mesh_options(CLI::App& app, MeshArguments& o, bool of_many = false);
mesher::Scene scene_from(const MeshArguments& o);
void check_planes(const MeshArguments& o, const mesher::Scene& scene);  // throws UsageError when --write-planes would overwrite what the scene reads
// Throws UsageError when an output has a name that it can't have. Outputs are checked before hours of work, not after.
void check_outputs(const MeshArguments& o, const mesher::Scene& scene);
// `share`: of the machine's memory, for one of several processes on it.
mesher::MeshOptions mesh_options(const MeshArguments& o, int share = 1);
// Of what a killed run has left, and this one throws away. `file`: the grid, or the part of it, that is written.
void warn_of_leftovers(const MeshArguments& o, const std::filesystem::path& file);
void warn_of_caps(const MeshArguments& o, const mesher::MeshReport& report);  // when none were written

}  // namespace teracell::cli
