// The facets that the CAD kernel wrote into a file, whose layout is in facets_file.hpp.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "mesher/surface/cad_facts.hpp"
#include "mesher/surface/part_tree.hpp"
#include "mesher/surface/units.hpp"
#include "store/base/descriptor.hpp"

namespace teracell::mesher {

// Adds a set of vertices and a shape for each of `facts`, which get what only the facets tell. The file has `size` bytes of facets. `factor`: from
// the kernel's unit. Throws FormatError where they are damaged, and InputError when a coordinate leaves its range; both begin with `name`.
void read_kernel_facets(const Descriptor& file, uint64_t size, const std::string& name, const Factor& factor, Shapes& shapes,
                        std::vector<CadShape>& facts);

}  // namespace teracell::mesher
