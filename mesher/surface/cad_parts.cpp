#include "mesher/surface/cad_parts.hpp"

#include <cmath>
#include <map>

#include <fmt/format.h>

#include "store/grid/number_text.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {

std::vector<CadPart> cad_parts(const PartTree& tree, const std::vector<uint32_t>& taken, const CadFacts& facts) {
  std::vector<CadPart> out;
  std::map<std::pair<uint32_t, double>, size_t> known;
  for (const uint32_t i : taken) {
    const Part& part = tree.parts()[i];
    const uint32_t shape = *tree.node(part).shape;
    const double volume = std::abs(determinant(part.matrix));
    const double scale = std::abs(volume - 1) < 1e-9 ? 1 : volume;
    const auto [place, fresh] = known.try_emplace({shape, scale}, out.size());
    if (!fresh) {
      ++out[place->second].instances;
      continue;
    }
    CadPart& made = out.emplace_back(CadPart{part.path, 1, facts.shapes[shape]});
    made.shape.scale(scale, std::pow(scale, 2.0 / 3));
  }
  return out;
}

std::vector<std::string> cad_warnings(const std::vector<CadPart>& parts, const CadFacts& facts) {
  constexpr size_t kMost = 20;
  std::vector<std::string> out;
  size_t more = 0;
  const auto warn = [&](std::string words) {
    if (out.size() < kMost) out.push_back(std::move(words));
    else ++more;
  };
  for (const CadPart& p : parts) {
    if (p.shape.faces_without_facets > 0)
      warn(fmt::format("the CAD kernel made no facets of {} of the {} faces of part {}", p.shape.faces_without_facets, p.shape.faces, p.path));
    const double most = 2 * facts.deflection * p.shape.facet_area;
    const std::pair<const char*, std::optional<double>> volumes[] = {
        {"the CAD kernel", p.shape.kernel_volume},
        {"the facets", p.shape.closed ? std::optional(std::abs(p.shape.facet_volume)) : std::nullopt},
        {"the sender", p.shape.sender_volume}};
    std::string differ;
    for (size_t a = 0; a < 3 && differ.empty(); ++a)
      for (size_t b = a + 1; b < 3 && differ.empty(); ++b)
        if (volumes[a].second && volumes[b].second && !(std::abs(*volumes[a].second - *volumes[b].second) <= most))
          differ = fmt::format("part {} has a volume of {} by {} and of {} by {}: they differ by more than the {} that facets within {} can explain",
                               p.path, number_text(*volumes[a].second, 7), volumes[a].first, number_text(*volumes[b].second, 7), volumes[b].first,
                               number_text(most, 3), number_text(facts.deflection, 3));
    if (!differ.empty()) warn(std::move(differ));
  }
  if (more > 0) out.push_back(fmt::format("there are {} more warnings of this kind", more));
  return out;
}

}  // namespace teracell::mesher
