// What meshing found, as JSON for people and programs.
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "mesher/binned_survey.hpp"
#include "mesher/bodies.hpp"

namespace teracell {

// What the cast counted.
struct CastTotals {
  uint64_t crossings = 0, exact_decisions = 0;
  std::vector<unsigned __int128> cells;  // that each body owns
};

// How the axis of the rays came about.
struct AxisChoice {
  int axis = 2;
  bool asked_for = false;
  Vec3 crossings;  // expected along each axis
};

// The report in the file: only what inputs and options determine, so no times, memory or counts of threads. One survey a
// body.
nlohmann::ordered_json make_report(const Scene& scene, const Bodies& bodies, const std::vector<SurveyTotals>& surveys, const Grid& grid,
                                   const AxisChoice& axis, const CastTotals& totals);

}  // namespace teracell
