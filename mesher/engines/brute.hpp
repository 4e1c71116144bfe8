// Traditional ray casting: every ray against every facet. See brute.cpp.
#pragma once
#include <memory>

#include "mesher/engines/engine.hpp"

namespace teracell {

class BruteEngine : public Engine {
 public:
  // `scene` are all its facets; those given to cast() are not looked at.
  explicit BruteEngine(std::shared_ptr<const std::vector<const SceneFacet*>> scene) : scene_(std::move(scene)) {}
  bool searches_scene() const override { return true; }
  void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) override;

 private:
  std::shared_ptr<const std::vector<const SceneFacet*>> scene_;
};

}  // namespace teracell
