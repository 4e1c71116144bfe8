// Scenes meshed in every way that must not show in the cells: axes, engines, chunks, threads, memory, vector units. A failure names the way.
#pragma once
#include "mesher/engines/engines.hpp"
#include "store/base/system/vector_units.hpp"
#include "tests/support/meshed.hpp"

namespace teracell::testing {

// Calls f(random) for each of `count` seeds from `first` on.
template <class F>
void for_seeds(uint64_t first, size_t count, F&& f) {
  for (uint64_t seed = first; seed < first + count; ++seed) {
    INFO("seed " << seed);
    std::mt19937_64 random(seed);
    f(random);
  }
}

// Calls check(reader, report) for rays along x, y and z.
template <class F>
void for_axes(const mesher::Scene& scene, mesher::MeshOptions options, F&& check) {
  const TempFolder folder;
  for (int axis = 0; axis < 3; ++axis) {
    INFO("rays along " << axis_name(axis));
    options.axis = axis;
    const auto report = mesh_quietly(scene, folder / "g.tcell", options);
    check(GridReader(folder / "g.tcell"), report);
  }
}

// The same by each engine. Under a sanitizer each engine has one axis, so that all engines and axes come up in each call, and each pair in
// one of three calls.
template <class F>
void for_engines_and_axes(const mesher::Scene& scene, mesher::MeshOptions options, F&& check) {
  static size_t call = 0;
  ++call;
  const TempFolder folder;
  options.threads = 1;
  const std::vector<std::string> engines = mesher::engine_names();
  for (size_t e = 0; e < engines.size(); ++e)
    for (int axis = 0; axis < 3; ++axis) {
      if (kSanitized && (e + call) % 3 != static_cast<size_t>(axis)) continue;
      INFO("rays along " << axis_name(axis) << ", engine " << engines[e]);
      options.axis = axis;
      options.engine = engines[e];
      const auto report = mesh_quietly(scene, folder / "g.tcell", options);
      check(GridReader(folder / "g.tcell"), report);
    }
}

// As long as it lives, loops run on a vector unit, or on the best one that there is if that is less.
class OnVectorUnit {
 public:
  explicit OnVectorUnit(VectorUnit unit) { vector_unit = std::min(unit, best_vector_unit()); }
  ~OnVectorUnit() { vector_unit = best_vector_unit(); }
};

// The same for chunks of several sizes, one of them wider than the grid. Threads, memory and vector units give the same file. Under a sanitizer each
// size has one axis.
template <class F>
void for_chunks_threads_and_memory(const mesher::Scene& scene, mesher::MeshOptions options, F&& check) {
  const TempFolder folder;
  constexpr std::array<uint32_t, 3> kRays = {4, 16, 64};
  for (int axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 3; ++i) {
      if (kSanitized && i != axis) continue;
      INFO("rays along " << axis_name(axis) << ", chunks of " << kRays[i] << " rays");
      options.axis = axis;
      options.chunk_rays = kRays[i];
      options.threads = 1;
      options.memory = ~uint64_t{0};
      const auto report = mesh_quietly(scene, folder / "a.tcell", options);
      check(GridReader(folder / "a.tcell"), report);
      for (const uint64_t memory : {uint64_t{1}, ~uint64_t{0}}) {
        const OnVectorUnit on(memory == 1 ? VectorUnit::kPlain : VectorUnit::kAvx2);
        options.threads = 3;
        options.memory = memory;
        const auto again = mesh_quietly(scene, folder / "b.tcell", options);
        REQUIRE((again["spilled_bytes"] > 0) == (memory == 1));
        REQUIRE(bytes_of(folder / "a.tcell") == bytes_of(folder / "b.tcell"));
        REQUIRE(again["bodies"] == report["bodies"]);
      }
    }
}

}  // namespace teracell::testing
