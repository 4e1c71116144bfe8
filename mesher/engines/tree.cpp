// Ray casting in which each ray finds its facets in an alternating digital tree: the modified ray casting of T. Ma, T. Ma,
// L. Hao (MSAM 2020), after J. Bonet, J. Peraire, "An alternating digital tree (ADT) algorithm for 3D geometric searching and
// intersection problems" (1991).
//
// A facet is represented by the point (u_min, u_max, v_min, v_max) of its projected box. The facets whose boxes contain a ray
// are those in a range: u_min <= u <= u_max, v_min <= v <= v_max. Each level of the tree halves its region in one of the four
// dimensions, in turn.
//
// Two things differ from the algorithm of 1991. A region is first shrunk to the points in it. So a search leaves empty space
// early, and no half is ever empty: facets with equal boxes, of which walls along the rays have thousands, become one leaf and
// not a chain of nodes. And the nodes are stored in the order of the search, with a few facets per leaf, which needs no stack.
#include "mesher/engines/tree.hpp"

#include <algorithm>
#include <cmath>

#include "mesher/engines/engines.hpp"
#include "mesher/engines/ray.hpp"

namespace teracell::mesher {

FacetTree::FacetTree(std::span<const SceneFacet* const> facets, const RayFrame& frame) {
  std::vector<Point> points;
  points.reserve(facets.size());
  for (const SceneFacet* facet : facets) {
    const auto& [a, b, c] = facet->facet.vertex;
    const auto [u_min, u_max] = std::minmax({a[frame.u], b[frame.u], c[frame.u]});
    const auto [v_min, v_max] = std::minmax({a[frame.v], b[frame.v], c[frame.v]});
    points.push_back({{u_min, u_max, v_min, v_max}, facet});
  }
  facets_.reserve(facets.size());
  if (!points.empty()) build(points, 0);
}

// Every level halves a dimension, so the range of doubles limits the depth to about two thousand, whatever the facets.
void FacetTree::build(std::span<Point> points, int dimension) {
  constexpr size_t kLeaf = 4;
  std::array<double, 4> lo, hi;
  lo.fill(HUGE_VAL), hi.fill(-HUGE_VAL);
  for (const Point& p : points) {
    for (int d = 0; d < 4; ++d) {
      lo[d] = std::min(lo[d], p.at[d]);
      hi[d] = std::max(hi[d], p.at[d]);
    }
  }
  const size_t node = nodes_.size();
  const auto first = static_cast<uint32_t>(facets_.size());
  nodes_.push_back({{lo[0], hi[1], lo[2], hi[3]}, 0, first, first + static_cast<uint32_t>(points.size())});
  for (int tries = 0; tries < 4 && lo[dimension] == hi[dimension]; ++tries) dimension = (dimension + 1) % 4;
  if (points.size() <= kLeaf || lo[dimension] == hi[dimension]) {
    for (const Point& p : points) facets_.push_back(p.facet);
  } else {
    // Between neighbouring doubles the middle is one of them; the least point goes below and the greatest above all the same.
    const double middle = lo[dimension] + (hi[dimension] - lo[dimension]) / 2, most = hi[dimension];
    const auto below = [&](const Point& p) { return p.at[dimension] <= middle && p.at[dimension] < most; };
    const auto upper = std::partition(points.begin(), points.end(), below);
    build({points.begin(), upper}, (dimension + 1) % 4);
    build({upper, points.end()}, (dimension + 1) % 4);
  }
  nodes_[node].skip = static_cast<uint32_t>(nodes_.size());
}

class TreeEngine : public Engine {
 public:
  // Tiles must have the frame of the tree; cast() ignores the facets it is given.
  explicit TreeEngine(std::shared_ptr<const FacetTree> tree) : tree_(std::move(tree)) {}
  bool searches_scene() const override { return true; }
  void cast(const Tile& tile, std::span<const SceneFacet* const> facets, Crossings& out) override;

 private:
  std::shared_ptr<const FacetTree> tree_;
};

void TreeEngine::cast(const Tile& tile, std::span<const SceneFacet* const>, Crossings& out) {
  out.begin.assign(1, 0);
  out.all.clear();
  for (const double v : tile.v) {
    for (const double u : tile.u) {
      tree_->search(u, v, [&](const SceneFacet& facet) { cross_ray(facet, tile, u, v, out.all, exact_decisions_); });
      check_crossings(tile, out.all.size());
      out.begin.push_back(static_cast<uint32_t>(out.all.size()));
    }
  }
}

namespace {

EngineMaker tree_maker(const RayFrame& frame, const AllFacets& all_facets) {
  return [tree = std::make_shared<const FacetTree>(all_facets(), frame)] { return std::make_unique<TreeEngine>(tree); };
}

}  // namespace

const EngineKind kTreeEngine = {"tree", true, tree_maker};

}  // namespace teracell::mesher
