// The planes of a grid as text, as "planes_file" of a scene reads them.
#pragma once
#include <filesystem>

#include "store/grid/grid.hpp"

namespace teracell::mesher {

std::filesystem::path planes_path(const std::filesystem::path& folder, int axis);  // x.txt, y.txt or z.txt

// Writes all three, and makes the folder if it isn't there. Numbers are read back as the same doubles. Throws IoError.
void write_planes(const Grid& grid, const std::filesystem::path& folder);

}  // namespace teracell::mesher
