// Any heap of facets is closed by its caps, by winding number and by parity; and the caps don't depend on the order.
#include <algorithm>
#include <cstdlib>

#include "mesher/closing/caps.hpp"

using namespace teracell;

using namespace teracell::mesher;

namespace {

Caps caps_of(const std::vector<Facet>& facets, bool evenodd) {
  const auto pass = [&](const auto& f) {
    for (const Facet& facet : facets) f(facet);
  };
  auto edges = boundary_edges(pass, uint64_t{1} << 26, "fuzz");
  if (evenodd) std::erase_if(edges, [](const BoundaryEdge& e) { return !e.odd(); });
  Caps caps;
  for (const Loop& loop : cut_into_loops(edges, evenodd)) cap_loop(loop, false, kIdentity, caps);
  return caps;
}

}  // namespace

// Each two bytes are a facet between three of 27 points.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  std::vector<Facet> facets;
  const auto point = [](uint32_t i) { return Vec3{static_cast<double>(i % 3), static_cast<double>(i / 3 % 3), static_cast<double>(i / 9 % 3)}; };
  for (size_t i = 0; i + 2 <= std::min<size_t>(size, 400); i += 2) {
    const uint32_t code = data[i] | data[i + 1] << 8;
    facets.push_back({{point(code % 27), point(code / 27 % 27), point(code / 729 % 27)}});
  }
  for (const bool evenodd : {false, true}) {
    const Caps caps = caps_of(facets, evenodd);
    BoundaryProof proof;
    for (const Facet& f : facets) proof.add(vertex_hashes(f));
    for (const Facet& f : caps.facets) proof.add(vertex_hashes(f));
    if (!(evenodd ? proof.undirected_boundary_is_empty() : proof.directed_boundary_is_empty())) std::abort();
    std::vector<Facet> reversed(facets.rbegin(), facets.rend());
    const Caps again = caps_of(reversed, evenodd);
    if (!std::ranges::equal(caps.facets, again.facets, {}, &Facet::vertex, &Facet::vertex)) std::abort();
  }
  return 0;
}
