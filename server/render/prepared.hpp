// What pictures of the same labels share, whatever they look at.
#pragma once
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
  size_t memory() const { return occupancy.memory() + density.memory(); }  // bytes on the heap
};

}  // namespace teracell::server
