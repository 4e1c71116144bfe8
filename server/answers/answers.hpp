// The answers about a grid. A new one is a file that defines its Answer, and a line here; openapi.json describes it.
#pragma once
#include "server/answers/answer.hpp"

// clang-format off
#define TERACELL_ANSWERS(answer) \
  answer(kInfoAnswer) \
  answer(kSliceAnswer) \
  answer(kPlaneAnswer) \
  answer(kTileAnswer) \
  answer(kCellAnswer) \
  answer(kColumnAnswer) \
  answer(kLineAnswer) \
  answer(kNearestAnswer) \
  answer(kThicknessAnswer) \
  answer(kBoxAnswer) \
  answer(kFileAnswer) \
  answer(kStatsAnswer) \
  answer(kCheckAnswer) \
  answer(kLeavesAnswer) \
  answer(kLeavesJsonAnswer) \
  answer(kDiffAnswer) \
  answer(kChangedAnswer) \
  answer(kViewPngAnswer) \
  answer(kViewBinAnswer) \
  answer(kViewJsonAnswer)
// clang-format on

namespace teracell::server {

#define DECLARED(name) extern const Answer name;
TERACELL_ANSWERS(DECLARED)
#undef DECLARED

}  // namespace teracell::server
