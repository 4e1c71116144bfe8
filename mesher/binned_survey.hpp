// The survey of bodies that are never in memory whole: bin by bin, then what the bins share.
#pragma once
#include <map>
#include <unordered_map>

#include "mesher/bins.hpp"
#include "mesher/survey.hpp"

namespace teracell {

struct SurveyTotals {
  uint64_t degenerate = 0, duplicates = 0, shells = 0;  // survey.hpp
};

// Memory: by the facets that lie in several bins, and by the shells. Not thread-safe.
class BinnedSurvey {
 public:
  explicit BinnedSurvey(size_t bodies) : bodies_(bodies) {}
  // The facets of a bin, one by one, between begin_bin() and end_bin(). `facets` is their number.
  void begin_bin(uint64_t facets);
  void add(const BinnedFacet& facet);
  void end_bin();
  std::vector<SurveyTotals> totals() const;

 private:
  // Shells within a bin that reach beyond it are nodes; a facet that lies in several bins joins those of its shell in each.
  struct Body {
    SurveyTotals totals;                           // shells: those within one bin
    std::unordered_map<uint64_t, uint32_t> nodes;  // of shared facets, by a hash of the first vertex
    std::vector<uint32_t> parent;                  // union-find over nodes
  };
  std::vector<Body> bodies_;
  // Of the bin at hand.
  std::map<uint32_t, Survey> surveys_;  // by body
  std::vector<std::pair<uint32_t, Vec3>> shared_;  // body and first vertex of the facets that lie in other bins too
};

}  // namespace teracell
