// The engines by name. All of them find the same crossings, at different costs. A new one is a file that defines its EngineKind, and
// a line here.
#pragma once
#include <string>
#include <vector>

#include "mesher/engines/engine.hpp"

// clang-format off
#define TERACELL_ENGINES(engine) \
  engine(kScanEngine) \
  engine(kSliceEngine) \
  engine(kTreeEngine) \
  engine(kBruteEngine)
// clang-format on

namespace teracell::mesher {

#define DECLARED(name) extern const EngineKind name;
TERACELL_ENGINES(DECLARED)
#undef DECLARED

// In the order of the list.
const std::vector<std::string>& engine_names();

// Whether an engine needs all facets in memory. Throws UsageError unless `name` is one of engine_names().
bool searches_scene(const std::string& name);

// A maker of engines for rays of `frame`. If the engine searches the scene, `all_facets` is called once, by this function, and
// the facets that it returns must outlive the engines. Throws UsageError unless `name` is one of engine_names().
EngineMaker engine_maker(const std::string& name, const RayFrame& frame, const AllFacets& all_facets);

}  // namespace teracell::mesher
