#include "tools/cli/commands.hpp"

// One line per command NAME: the file NAME.cpp defines setup_NAME().
// clang-format off
#define TERACELL_COMMANDS(command) \
  command(mesh, "mesh a scene or bare surfaces into a .tcell file") \
  command(scene, "write a scene to edit, with a body for each part of assemblies") \
  command(merge, "put the parts of a grid together that were made apart") \
  command(info, "what a grid, a surface or an assembly holds") \
  command(slice, "one slice as a picture (.png) or an array (.npy)") \
  command(render, "a picture in three dimensions (.png, .jpg)") \
  command(column, "the runs of one column along any axis") \
  command(stats, "exact cells, volume and box of every material") \
  command(check, "what is wrong with a grid, or worth knowing") \
  command(diff, "which cells of two grids have different materials") \
  command(export, "a box of cells in the format of another program") \
  command(partition, "boxes of equal work for the ranks of a parallel program") \
  command(pack, "the same cells laid out for reading from far away") \
  command(page, "the dashboard without a server: files for a host, or one HTML file") \
  command(verify, "check every byte and every invariant of a file") \
  command(sample, "write a built-in scene") \
  command(serve, "grids over HTTP: pictures, numbers, the formats of other viewers")
// clang-format on

namespace teracell::cli {

#define DECLARED(name, summary) Run setup_##name(CLI::App&);
#define LISTED(name, summary) {#name, summary, setup_##name},

TERACELL_COMMANDS(DECLARED)

const std::vector<Command>& commands() {
  static const std::vector<Command> list = {TERACELL_COMMANDS(LISTED)};
  return list;
}

#undef DECLARED
#undef LISTED

}  // namespace teracell::cli
