// What `teracell info` says of files that are no grids: surfaces and assemblies.
#pragma once
#include <string>
#include <vector>

#include "mesher/surface/read_options.hpp"

namespace teracell::cli {

// Whether a name is that of a grid: an address, or a file that begins as grids do. What can't be read is left to what reads grids.
bool names_a_grid(const std::string& name);
void print_surfaces(const std::vector<std::string>& names, bool json, const mesher::CadOptions& cad);

}  // namespace teracell::cli
