// Counts what casting finds. Sums do not depend on the order in which they are taken.
#pragma once
#include <cstdint>
#include <vector>

#include "mesher/boundary/share_sums.hpp"
#include "mesher/compose/compose.hpp"
#include "mesher/overlaps/overlap_sum.hpp"
#include "mesher/thin/tally.hpp"
#include "store/base/bytes.hpp"
#include "store/format/cell_sums.hpp"

namespace teracell::mesher {

// What casting a row of tiles has counted.
struct RowTotals {
  uint64_t crossings = 0, exact_decisions = 0;
  LabelsSum labels;
  std::vector<BodyCells> cells;
  Tallies tallies;
  OverlapSum overlaps;
  ShareSums shares;
};

// What all casting has counted.
struct CastTotals {
  uint64_t crossings = 0, exact_decisions = 0;
  CellSums sums;  // of the cells so far
  std::vector<unsigned __int128> cells, covered;  // one per body: cells that it owns, and cells in it that a stronger body owns
  Tallies tallies;
  OverlapSum overlaps;
  ShareSums shares;
  void add(const RowTotals& row);
  void add(const CastTotals& other);  // of the same bodies
  void save(Bytes& out) const;
  static CastTotals restored(ByteReader& in);
};

}  // namespace teracell::mesher
