#include "mesher/scene/auto_planes.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/grid/grid.hpp"

namespace teracell::mesher {
namespace {

constexpr std::array<std::string_view, 3> kSnaps = {"faces", "thirds", "none"};  // in the order of AutoPlanes::Snap
constexpr int64_t kMostPad = 1'000'000;
constexpr double kLeastGrowth = 1.01, kMostGrowth = 10;

void check_width(const JsonNode& node, double width, double finest) {
  if (width < 2 * finest)
    throw UsageError(
        fmt::format("{}: expected at least twice \"finest\", {}, so that whole cells fit into any gap; found {}", node.where(), 2 * finest, width));
}

CellsWithin parse_cells_within(const JsonNode& node, double finest) {
  node.check_keys({"step", "across"});
  CellsWithin out;
  if (const auto n = node.find("step")) check_width(*n, *(out.step = n->positive()), finest);
  if (const auto n = node.find("across")) out.across = n->integer(1, Axis::kMaxCells);
  if (!out.step && !out.across) node.fail("\"step\", \"across\" or both");
  return out;
}

std::vector<double> parse_fixed(const JsonNode& node) {
  std::vector<double> out;
  for (const JsonNode& n : node.items()) out.push_back(n.number() + 0.0);
  std::ranges::sort(out);
  out.erase(std::ranges::unique(out).begin(), out.end());
  return out;
}

// Without "fixed", whose form depends on the place.
AutoPlanes parse(const JsonNode& node) {
  node.check_keys({"finest", "coarsest", "growth", "snap", "resolution", "fixed", "metals", "pad"});
  AutoPlanes out;
  out.finest = node.require("finest").positive();
  const JsonNode coarsest = node.require("coarsest");
  check_width(coarsest, out.coarsest = coarsest.positive(), out.finest);
  if (!(out.coarsest <= 1e60)) coarsest.fail("a length up to 1e60");
  if (const auto n = node.find("growth")) {
    out.growth = n->number();
    if (!(out.growth >= kLeastGrowth && out.growth <= kMostGrowth)) n->fail(fmt::format("a factor from {} to {}", kLeastGrowth, kMostGrowth));
  }
  if (const auto n = node.find("snap")) out.snap = static_cast<AutoPlanes::Snap>(n->choice(kSnaps));
  if (const auto n = node.find("resolution"))
    for (const JsonNode& of : n->members()) out.resolution[std::string(of.key())] = parse_cells_within(of, out.finest);
  if (const auto n = node.find("metals"))
    for (const JsonNode& m : n->items()) out.metals.push_back(m.text());
  if (out.snap == AutoPlanes::Snap::kThirds && out.metals.empty())
    throw UsageError(fmt::format("{}: \"snap\": \"thirds\" needs \"metals\": names of the bodies or materials whose faces are meant", node.where()));
  if (const auto n = node.find("pad")) out.pad = n->integer(0, kMostPad);
  return out;
}

}  // namespace

std::array<AutoPlanes, 3> parse_auto_of_grid(const JsonNode& node) {
  std::array<AutoPlanes, 3> out;
  out.fill(parse(node));
  if (const auto fixed = node.find("fixed")) {
    fixed->check_keys({"x", "y", "z"});
    for (int a = 0; a < 3; ++a)
      if (const auto n = fixed->find(axis_name(a))) out[a].fixed = parse_fixed(*n);
  }
  return out;
}

AutoPlanes parse_auto_of_axis(const JsonNode& node) {
  AutoPlanes out = parse(node);
  if (const auto n = node.find("fixed")) out.fixed = parse_fixed(*n);
  return out;
}

void refuse_fixed(int axis, double lo, double hi, double at) {
  throw UsageError(
      fmt::format("grid: \"fixed\" of axis {}: expected planes from {} to {}, where the domain lies, found {}", axis_name(axis), lo, hi, at));
}

Json normalised(const AutoPlanes& planes, bool has_domain) {
  Json out = {{"finest", planes.finest}, {"coarsest", planes.coarsest}, {"growth", planes.growth}};
  out["snap"] = kSnaps[static_cast<size_t>(planes.snap)];
  for (const auto& [name, within] : planes.resolution) {
    Json& of = out["resolution"][name];
    if (within.step) of["step"] = *within.step;
    if (within.across) of["across"] = *within.across;
  }
  if (!planes.fixed.empty()) out["fixed"] = planes.fixed;
  if (!planes.metals.empty()) out["metals"] = planes.metals;
  if (!has_domain) out["pad"] = planes.pad;
  return out;
}

}  // namespace teracell::mesher
