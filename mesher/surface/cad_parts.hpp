// The parts that are taken of a file of exact surfaces, and where their volumes don't agree.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "mesher/surface/cad_facts.hpp"
#include "mesher/surface/part_tree.hpp"

namespace teracell::mesher {

// Each shape and scale once. `taken`: numbers of parts of the tree.
std::vector<CadPart> cad_parts(const PartTree& tree, const std::vector<uint32_t>& taken, const CadFacts& facts);

// Of the parts that have faces without facets, or whose volume by the kernel, by the facets and by the sender differ by more than facets so fine can
// explain, 2 * deflection * area: a sentence for each of the first ones, and one for how many there are.
std::vector<std::string> cad_warnings(const std::vector<CadPart>& parts, const CadFacts& facts);

}  // namespace teracell::mesher
