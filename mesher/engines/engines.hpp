// The engines by name. All of them find the same crossings; they differ in what that costs.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "mesher/engines/engine.hpp"

namespace teracell {

// The default first.
const std::vector<std::string>& engine_names();

// Makes engines, one for each thread. What they share lives as long as the maker or any of them; threads may call it at once.
using EngineMaker = std::function<std::unique_ptr<Engine>()>;

// For rays of `frame`. `all_facets` is called, once and here, only if the engine searches the scene; the facets it lists
// must outlive the engines. Throws UsageError unless `name` is one of engine_names().
EngineMaker engine_maker(const std::string& name, const Frame& frame, const std::function<std::vector<const SceneFacet*>()>& all_facets);

}  // namespace teracell
