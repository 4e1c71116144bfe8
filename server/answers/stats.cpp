// How many cells of a box each material has, its volume and its box.
#include "server/answers/answers.hpp"

#include "store/read/stats.hpp"
#include "store/whole/info.hpp"

namespace teracell::server {
namespace {

Response answer_stats(const GridRequest& r) {
  r.target.allow({"v", "region", "bodies"});
  const bool bodies = asks_for_bodies(r);
  const Box box = region_of(r);
  return json_answer(r, "stats", [&, box, bodies] {
    const auto stats = read_label_stats(r.reader(), box);
    return bodies ? body_stats_json(r.meta(), box, stats) : stats_json(r.meta(), box, stats_by_material(r.meta(), stats));
  });
}

}  // namespace

const Answer kStatsAnswer = {"stats", 1, Cost::kDear, answer_stats};

}  // namespace teracell::server
