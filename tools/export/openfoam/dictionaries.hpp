// The dictionaries in `system` without which no program of OpenFOAM begins: those that a case lacks, for a first run.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace teracell::exports::foam {

// Writes controlDict, fvSchemes, fvSolution and, for a mesh in parts, decomposeParDict, but no file that is there already. Returns the names of
// those that were written, within the case. Throws IoError.
std::vector<std::string> write_dictionaries(const std::filesystem::path& folder, std::optional<uint32_t> parts);

// The number of parts that the case's decomposeParDict states, if it states one other than `parts`: programs of OpenFOAM refuse to start then.
std::optional<uint32_t> other_parts(const std::filesystem::path& folder, uint32_t parts);

}  // namespace teracell::exports::foam
