// What pictures of the same labels share, whatever they look at.
#pragma once
#include "server/render/cells/differing.hpp"
#include "server/render/openness.hpp"

namespace teracell::server {

struct Prepared {
  Visible visible;
  Occupancy occupancy;
  Density density;
  // `shown`: of each label. Occupancy begins with `level` where it fits.
  Prepared(const GridReader& reader, std::vector<bool> shown, int level, int threads, bool damage = false)
      : visible(std::move(shown), damage),
        occupancy(reader, visible, level, threads),
        density(reader.meta().grid, reader.meta().frame(), occupancy) {}
  // The same of what differs.
  Prepared(const GridReader& reader, const GridReader& against, int level, bool damage)
      : visible(std::vector<bool>(kDifferences, true), damage),
        occupancy(reader, level,
                  [differing = std::make_shared<Differing>(reader, against, damage)](int at, const Index3& cell) { return differing->at(at, cell); }),
        density(reader.meta().grid, reader.meta().frame(), occupancy) {}
  size_t memory() const { return occupancy.memory() + density.memory(); }  // bytes on the heap
};

}  // namespace teracell::server
