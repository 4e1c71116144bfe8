// Casts the rays of tile groups with several threads, and puts the chunks into a file in the order of the tree.
#pragma once
#include <functional>

#include "mesher/run/prepared_run.hpp"
#include "mesher/run/tile_group.hpp"

namespace teracell::mesher {

class Casting {
 public:
  // Keeps a reference to `run`.
  Casting(const PreparedRun& run, const EngineMaker& make_engine);

  // Takes groups of `tiling` from `next`, which several threads call one at a time, until there are no more; these threads also load its bins. Puts
  // the groups' chunks, and what is above them. `stored` is called on this thread for each group, when its chunks are put, with what it has counted.
  void cast(Tiling& tiling, const std::function<std::optional<TileGroup>()>& next, PyramidWriter& pyramid,
            const std::function<void(const TileGroupWork&)>& stored);

 private:
  const PreparedRun& run_;
  std::vector<Layer> layers_;  // by layer_of()
  std::vector<std::unique_ptr<Worker>> workers_;
};

CastTotals no_totals(const Scene& scene);
void add_totals(CastTotals& sum, const TileGroupWork& group);

}  // namespace teracell::mesher
