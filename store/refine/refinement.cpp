#include "store/refine/refinement.hpp"

#include <algorithm>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/channels/links.hpp"
#include "store/text/name_list.hpp"
#include "store/text/words.hpp"

namespace teracell::inline store {
namespace {

constexpr std::string_view kSelectors = "interface=L, patch:NAME=L, material:NAME=L, inside:NAME=L or box:X0,Y0,Z0,X1,Y1,Z1=L";

// The selectors of a list, cut at the commas that are neither in quotes nor between the numbers of a box: those before something that isn't a
// number.
std::vector<std::string_view> selectors_in(std::string_view list) {
  std::vector<std::string_view> out;
  bool quoted = false;
  size_t begin = 0;
  for (size_t i = 0; i <= list.size(); ++i) {
    if (i < list.size() && list[i] == '"') quoted = !quoted;
    if (i < list.size() && (list[i] != ',' || quoted)) continue;
    const std::string_view one = list.substr(begin, i - begin);
    if (one.starts_with("box:") && one.find('=') == one.npos && i < list.size()) continue;
    out.push_back(one);
    begin = i + 1;
  }
  return out;
}

class Selectors {
 public:
  Selectors(const Metadata& meta, std::string_view option, Refinement& out) : meta_(meta), option_(option), out_(out) {}

  void take(std::string_view selector) {
    const size_t equal = selector.rfind('=');
    const auto level = equal == selector.npos ? std::nullopt : number_in<int>(selector.substr(equal + 1));
    if (!level || *level < 0 || *level > kCoarsest)
      throw UsageError(fmt::format("{}: expected {} with a level L from 0 to {}, found '{}'", option_, kSelectors, kCoarsest, selector));
    const std::string_view what = selector.substr(0, equal);
    if (what == "interface") out_.interfaces = std::exchange(said_, true) ? std::min(out_.interfaces, *level) : *level;
    else if (what.starts_with("box:")) out_.boxes.push_back({box_of(what.substr(4)), *level});
    else if (what.starts_with("material:")) finer(out_.of_materials, material(what.substr(9)), meta_.materials.size(), *level);
    else if (what.starts_with("inside:")) finer(out_.inside, material(what.substr(7)), meta_.materials.size(), *level);
    else if (what.starts_with("patch:")) finer(out_.of_patches, patch(what.substr(6)), meta_.patches.size(), *level);
    else throw UsageError(fmt::format("{}: expected {}, found '{}'", option_, kSelectors, selector));
  }

 private:
  static void finer(std::vector<int>& levels, size_t i, size_t all, int level) {
    levels.resize(all, kNoLevel);
    levels[i] = std::min(levels[i], level);
  }

  std::string name(std::string_view text) const {
    const std::vector<std::string> names = text.empty() ? std::vector<std::string>() : names_in(text, option_);
    if (names.size() != 1) throw UsageError(fmt::format("{}: expected one name, in double quotes where it has a comma, found '{}'", option_, text));
    return names.front();
  }

  template <class Info>
  size_t place(const std::vector<Info>& infos, const std::string& wanted, const char* kind) const {
    const auto it = std::ranges::find(infos, wanted, &Info::name);
    if (it != infos.end()) return static_cast<size_t>(it - infos.begin());
    std::vector<std::string> names;
    for (const Info& info : infos) names.push_back(info.name);
    throw UsageError(fmt::format("{}: the grid has no {} '{}': it has {}", option_, kind, wanted, listed(names)));
  }
  size_t material(std::string_view text) const { return place(meta_.materials, name(text), "material"); }
  size_t patch(std::string_view text) const {
    if (find_links(meta_) == nullptr)
      throw UsageError(fmt::format("{}: the grid has no links, which tell where patches lie: it was meshed without them", option_));
    return place(meta_.patches, name(text), "patch");
  }

  Box box_of(std::string_view text) const {
    const auto numbers = numbers_in<int64_t>(text, 6);
    Box box;
    for (size_t d = 0; numbers && d < 3; ++d) box.lo[d] = (*numbers)[d], box.hi[d] = (*numbers)[d + 3];
    const Index3 n = meta_.grid.cells();
    if (!numbers || box.empty() || !overlap(box, {{0, 0, 0}, n}))
      throw UsageError(fmt::format("{}: expected box:X0,Y0,Z0,X1,Y1,Z1=L, half open, in the grid's {} x {} x {} cells, found 'box:{}'", option_, n[0],
                                   n[1], n[2], text));
    for (size_t d = 0; d < 3; ++d) box.lo[d] = std::max<int64_t>(box.lo[d], 0), box.hi[d] = std::min(box.hi[d], n[d]);
    return box;
  }

  bool said_ = false;  // of all interfaces
  const Metadata& meta_;
  const std::string_view option_;
  Refinement& out_;
};

}  // namespace

Refinement parse_refinement(const Metadata& meta, int coarsest, int layers, std::string_view wants, std::string_view want) {
  if (coarsest < 0 || coarsest > kCoarsest) throw UsageError(fmt::format("coarsest: expected a level from 0 to {}, found {}", kCoarsest, coarsest));
  if (layers < 1 || layers > kMostLayers) throw UsageError(fmt::format("layers: expected 1 to {}, found {}", kMostLayers, layers));
  Refinement out;
  out.coarsest = coarsest, out.layers = layers;
  if (wants.empty()) return out;
  Selectors selectors(meta, want, out);
  for (const std::string_view selector : selectors_in(wants)) selectors.take(selector);
  return out;
}

Refinement parse_refinement(const Metadata& meta, std::string_view levels, std::string_view wants, std::string_view refine, std::string_view want) {
  const std::vector<std::string_view> parts = split(levels, ',');
  const auto coarsest = number_in<int>(parts[0]), layers = parts.size() > 1 ? number_in<int>(parts[1]) : std::optional(Refinement{}.layers);
  if (parts.size() > 2 || !coarsest || !layers || *coarsest < 0 || *coarsest > kCoarsest || *layers < 1 || *layers > kMostLayers)
    throw UsageError(fmt::format("{}: expected M,N, the coarsest level M from 0 to {} and N layers from 1 to {}, found '{}'", refine, kCoarsest,
                                 kMostLayers, levels));
  return parse_refinement(meta, *coarsest, *layers, wants, want);
}

}  // namespace teracell::store
