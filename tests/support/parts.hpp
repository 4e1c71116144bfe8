// Grids made in parts and in pieces, and runs that are killed.
#pragma once
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/meshed.hpp"

namespace teracell::testing {

inline const mesher::Progress kSilent = [](const char*, double, double) {};
inline const std::atomic<bool> kGoOn{false};

// Solids that overlap, one of them moved and open, and one with parts thinner than a cell, on rays that meet vertices and edges.
inline mesher::Scene scene_in_parts(const TempFolder& folder, int cells = 300) {
  const Grid grid{
      {Axis::uniform(-5, 10. / cells, 0, cells, 0.5), Axis::uniform(-5, 10. / cells, 0, cells + 7, 0.5), Axis::uniform(-5, 0.1, 0, 100, 0.5)}};
  auto open = shapes::torus({0, 0, 1}, 3, 1.5, 40, 30);
  open.pop_back();
  mesher::Scene scene = scene_of(folder, {{shapes::sphere({0, 0, 0}, 4, 3)}, {open, oracle::Rule::kNonzero, 2}}, grid);
  scene.bodies[0].fill = Fill::kAuto;
  scene.bodies[1].matrix[3] = 0.25;
  return scene;
}

inline mesher::MeshOptions options_of_parts(int axis) { return {.axis = axis, .thin = true, .chunk_rays = 8}; }

inline std::filesystem::path make_part(const mesher::Scene& scene, const std::filesystem::path& output, mesher::MeshOptions options,
                                       const mesher::Shard& shard) {
  options.shard = shard;
  mesh(scene, output, options, kSilent, kGoOn);
  return part_path(output, shard);
}

inline std::vector<std::filesystem::path> make_parts(const mesher::Scene& scene, const std::filesystem::path& output,
                                                     const mesher::MeshOptions& options, uint32_t of) {
  std::vector<std::filesystem::path> parts;
  for (uint32_t i = 0; i < of; ++i) parts.push_back(make_part(scene, output, options, {i, of}));
  return parts;
}

// Runs in a child, which calls prepare() first, and kills it at the given call of progress.
inline void run_and_kill(
    const mesher::Scene& scene, const std::filesystem::path& output, const mesher::MeshOptions& options, int call, void (*prepare)() = [] {}) {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    prepare();
    int calls = 0;
    mesh(
        scene, output, options,
        [&](const char*, double, double) {
          if (++calls == call) kill(getpid(), SIGKILL);
        },
        kGoOn);
    _exit(0);
  }
  int status = 0;
  REQUIRE(waitpid(child, &status, 0) == child);
  REQUIRE(WIFSIGNALED(status));
  REQUIRE_FALSE(std::filesystem::exists(output));
}

}  // namespace teracell::testing
