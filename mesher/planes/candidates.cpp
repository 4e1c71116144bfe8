#include "mesher/planes/candidates.hpp"

#include <algorithm>
#include <map>
#include <tuple>

namespace teracell::mesher {

constexpr double kSameArea = 1e-9;  // relative: areas are sums, whose last digits depend on where a body stands

Kept merged(std::vector<Candidate> candidates, double finest, double same) {
  std::ranges::stable_sort(candidates,
                           [](const Candidate& a, const Candidate& b) { return std::tie(a.rank, b.area, a.at) < std::tie(b.rank, a.area, b.at); });
  for (auto first = candidates.begin(), end = first; first != candidates.end(); first = end) {
    const auto differ = [](const Candidate& a, const Candidate& b) { return a.rank != b.rank || b.area < a.area * (1 - kSameArea); };
    end = std::adjacent_find(first, candidates.end(), differ);
    if (end != candidates.end()) ++end;
    std::stable_sort(first, end, [](const Candidate& a, const Candidate& b) { return a.at < b.at; });
  }
  Kept out;
  std::map<double, const Candidate*> kept;
  for (const Candidate& c : candidates) {
    const auto above = kept.lower_bound(c.at);
    const Candidate* nearest = above == kept.end() ? nullptr : above->second;
    if (above != kept.begin()) {
      const Candidate* below = std::prev(above)->second;
      if (!nearest || c.at - below->at <= nearest->at - c.at) nearest = below;
    }
    const double distance = nearest ? std::max(nearest->at - c.at, c.at - nearest->at) : finest;
    if (distance >= finest * (1 - 1e-9) || c.rank == Candidate::Rank::kSide) kept.emplace(c.at, &c);
    else if (distance > same) out.losses.push_back({c, *nearest});
  }
  for (const auto& [at, c] : kept) out.at.push_back(at);
  return out;
}

}  // namespace teracell::mesher
