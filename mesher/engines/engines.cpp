#include "mesher/engines/engines.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

#define LISTED(name) &name,
constexpr const EngineKind* kEngines[] = {TERACELL_ENGINES(LISTED)};
#undef LISTED

const EngineKind& kind_named(const std::string& name) {
  const auto kind = std::ranges::find(kEngines, name, &EngineKind::name);
  if (kind == std::end(kEngines))
    throw UsageError(fmt::format("expected one of the engines {1}, found '{0}'", name, fmt::join(engine_names(), ", ")));
  return **kind;
}

}  // namespace

const std::vector<std::string>& engine_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const EngineKind* kind : kEngines) out.push_back(kind->name);
    return out;
  }();
  return names;
}

bool searches_scene(const std::string& name) { return kind_named(name).searches_scene; }

EngineMaker engine_maker(const std::string& name, const RayFrame& frame, const AllFacets& all_facets) {
  return kind_named(name).maker(frame, all_facets);
}

}  // namespace teracell::mesher
