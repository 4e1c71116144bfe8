// Traditional ray casting: every ray is tested against every facet. See brute.cpp.
#pragma once
#include <memory>

#include "mesher/engines/engine.hpp"

namespace teracell::mesher {

class BruteEngine : public Engine {
 public:
  // `scene` holds all facets of the scene; cast() ignores those it is given.
  explicit BruteEngine(std::shared_ptr<const std::vector<const SceneFacet*>> scene) : scene_(std::move(scene)) {}
  bool searches_scene() const override { return true; }
  void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) override;

 private:
  std::shared_ptr<const std::vector<const SceneFacet*>> scene_;
};

}  // namespace teracell::mesher
