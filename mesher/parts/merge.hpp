// Puts the parts of a grid together: the bytes of one run.
#pragma once
#include "mesher/pipeline.hpp"

namespace teracell::mesher {

// `parts`: in any order. Throws InputError when one is missing, double, or of another run; FormatError when one is damaged. Nothing stands
// under the output's name then.
MeshReport merge(const std::vector<std::filesystem::path>& parts, const std::filesystem::path& output, const Progress& progress,
                 const std::atomic<bool>& stop);

}  // namespace teracell::mesher
