// Counts what lies between sample points while rays are cast: how often, how wide, and where. The result does not depend on the
// order of the tiles.
#pragma once
#include <compare>
#include <cstdint>
#include <map>

#include "mesher/engines/sub_position.hpp"
#include "store/base/bytes.hpp"

namespace teracell::mesher {

struct TallyKey {
  enum class What : uint8_t {
    kPairs,      // pairs of crossings of a body along a ray, between the same two sample points
    kStretches,  // lost stretches of a body
    kGaps,       // lost gaps in a material
    kLowerSide,  // lines that cross a sheet exactly on the domain's lower side
  };
  What what;
  uint32_t of;    // the body or the material
  uint8_t axis;
  friend auto operator<=>(const TallyKey&, const TallyKey&) = default;
};

struct Tally {
  uint64_t number = 0;
  // The widest one by its length, 0 where widths aren't counted; of equal ones the one with the least z, then y, then x. It begins at q(from) of
  // `cell` along the axis and is `widest` sub-positions wide.
  double length = 0;
  uint32_t widest = 0, from = 0;
  Index3 cell{};
  void add(const Tally& other);
};

// The middle of the widest one.
Vec3 place_of(const TallyKey& key, const Tally& tally, const Grid& grid);
// The length of so many sub-positions between the sample points of cell i and the next one.
double length_of(const Axis& axis, int64_t i, uint32_t sub_positions);

class Tallies {
 public:
  void add(const TallyKey& key, const Tally& tally);
  void add(const Tallies& other);
  const Tally* find(const TallyKey& key) const;
  const std::map<TallyKey, Tally>& all() const { return all_; }

  void save(Bytes& out) const;
  static Tallies restored(ByteReader& in);

 private:
  std::map<TallyKey, Tally> all_;
};

}  // namespace teracell::mesher
