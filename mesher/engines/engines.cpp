#include "mesher/engines/engines.hpp"

#include <cassert>

#include "mesher/engines/brute.hpp"
#include "mesher/engines/scan.hpp"
#include "mesher/engines/slice.hpp"
#include "mesher/engines/tree.hpp"

namespace teracell {

const std::vector<std::string>& engine_names() {
  static const std::vector<std::string> names = {"scan", "slice", "tree", "brute"};
  return names;
}

EngineMaker engine_maker(const std::string& name, const Frame& frame, const std::function<std::vector<const SceneFacet*>()>& all_facets) {
  if (name == "scan") return [] { return std::make_unique<ScanEngine>(); };
  if (name == "slice") return [] { return std::make_unique<SliceEngine>(); };
  if (name == "tree") return [tree = std::make_shared<const FacetTree>(all_facets(), frame)] { return std::make_unique<TreeEngine>(tree); };
  assert(name == "brute");
  return [scene = std::make_shared<const std::vector<const SceneFacet*>>(all_facets())] { return std::make_unique<BruteEngine>(scene); };
}

}  // namespace teracell
