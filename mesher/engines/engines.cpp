#include "mesher/engines/engines.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/engines/brute.hpp"
#include "mesher/engines/scan.hpp"
#include "mesher/engines/slice.hpp"
#include "mesher/engines/tree.hpp"
#include "store/error.hpp"

namespace teracell {

const std::vector<std::string>& engine_names() {
  static const std::vector<std::string> names = {"scan", "slice", "tree", "brute"};
  return names;
}

EngineMaker engine_maker(const std::string& name, const RayFrame& frame, const std::function<std::vector<const SceneFacet*>()>& all_facets) {
  if (name == "scan") return [] { return std::make_unique<ScanEngine>(); };
  if (name == "slice") return [] { return std::make_unique<SliceEngine>(); };
  if (name == "tree") return [tree = std::make_shared<const FacetTree>(all_facets(), frame)] { return std::make_unique<TreeEngine>(tree); };
  if (name != "brute") throw UsageError(fmt::format("expected one of the engines {1}, found '{0}'", name, fmt::join(engine_names(), ", ")));
  return [scene = std::make_shared<const std::vector<const SceneFacet*>>(all_facets())] { return std::make_unique<BruteEngine>(scene); };
}

}  // namespace teracell
