// The leaves of a refined grid: the level of each in a tile of a slice, and how many there are.
#include "server/answers/answers.hpp"

#include <fmt/format.h>

#include "store/refine/leaf_levels.hpp"
#include "store/refine/leaf_table.hpp"

namespace teracell::server {
namespace {

Refinement refinement_of(const GridRequest& r) {
  const std::string *levels = r.target.find("refine"), *wants = r.target.find("want");
  if (levels == nullptr) throw bad_request("missing refine: expected the coarsest level and the layers of cells, as in 8,2");
  return parse_refinement(r.meta(), *levels, wants ? *wants : "", "refine", "want");
}

std::shared_ptr<const RefinedGrid> refined(const GridRequest& r, const Refinement& refinement) {
  const size_t memory = r.service.refined().counts().limit * 3 / 8;  // so that there is room for two
  const std::string* wants = r.target.find("want");
  return r.service.refined().get(fmt::format("{} {},{} {}", r.grid->number, refinement.coarsest, refinement.layers, wants ? *wants : ""),
                                 [&] { return std::pair(std::make_shared<const RefinedGrid>(r.grid, refinement, memory), memory); });
}

Response answer_leaves(const GridRequest& r) {
  const auto [view, extension] = tile_of(r);
  if (extension != ".bin") throw not_found(fmt::format("tiles of leaves are .bin, found '{}'", extension.substr(0, 48)));
  r.target.allow({"v", "refine", "want"});
  const Refinement refinement = refinement_of(r);
  return r.answer({.route = "leaves", .content_type = "application/octet-stream", .compress = true, .make = [&r, tile = view, refinement] {
                     const auto levels =
                         refined(r, refinement)->with(cells_below(tile), [&](const Leaves& leaves) { return leaf_levels(leaves, tile); });
                     return std::string(levels.begin(), levels.end());
                   }});
}

Response answer_count(const GridRequest& r) {
  r.target.allow({"v", "refine", "want", "region"});
  const Refinement refinement = refinement_of(r);
  const Box box = region_of(r);
  return json_answer(r, "leaves_json", [&r, refinement, box] {
    const auto counts =
        refined(r, refinement)->with(box, [&](const Leaves& leaves) { return leaves.count(box, 1, [](double) { Wanted::stop_if_not(); }); });
    return LeafTable(r.meta(), refinement, counts).json();
  });
}

}  // namespace

const Answer kLeavesAnswer = {"leaves", 5, Cost::kSeen, answer_leaves};
const Answer kLeavesJsonAnswer = {"leaves.json", 1, Cost::kDear, answer_count};

}  // namespace teracell::server
