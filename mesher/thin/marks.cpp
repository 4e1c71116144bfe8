#include "mesher/thin/marks.hpp"

namespace teracell::mesher {

void Marks::reset(uint32_t rays) {
  all_.clear();
  last_.assign(rays, kNone);
}

void Marks::join(const Tile& tile, Crossings& crossings) {
  if (all_.empty()) return;
  check_crossings(tile, crossings.all.size() + 2 * all_.size());
  next_.assign(last_.size() + 1, 0);
  for (const Stretch& s : all_) next_[s.ray + 1] += 2;
  joined_.resize(crossings.all.size() + 2 * all_.size());
  for (size_t ray = 0; ray < last_.size(); ++ray) {  // a ray's crossings, then its marks
    const uint32_t begin = crossings.begin[ray], end = crossings.begin[ray + 1];
    next_[ray + 1] += next_[ray];
    std::copy(crossings.all.begin() + begin, crossings.all.begin() + end, joined_.begin() + begin + next_[ray]);
    crossings.begin[ray] = begin + next_[ray];
    next_[ray] += end;
  }
  crossings.begin.back() = static_cast<uint32_t>(joined_.size());
  for (const Stretch& s : all_) {
    joined_[next_[s.ray]++] = Crossing::pack(s.from, s.layer, true) | Crossing::kMark;
    joined_[next_[s.ray]++] = Crossing::pack(s.to, s.layer, false) | Crossing::kMark;
  }
  crossings.all.swap(joined_);
}

}  // namespace teracell::mesher
