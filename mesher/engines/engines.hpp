// The engines by name. All of them find the same crossings, at different costs.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "mesher/engines/engine.hpp"

namespace teracell {

// The default engine is the first.
const std::vector<std::string>& engine_names();

// Makes engines, one for each thread. What the engines share lives as long as the maker or any of the engines. Threads may call
// it at the same time.
using EngineMaker = std::function<std::unique_ptr<Engine>()>;

// A maker of engines for rays of `frame`. If the engine searches the scene, `all_facets` is called once, by this function, and
// the facets that it returns must outlive the engines. Throws UsageError unless `name` is one of engine_names().
EngineMaker engine_maker(const std::string& name, const RayFrame& frame, const std::function<std::vector<const SceneFacet*>()>& all_facets);

}  // namespace teracell
