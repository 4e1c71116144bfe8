// Files that others made, in a folder beside the checkout, for tests that run where it is.
#pragma once
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <optional>

namespace teracell::testing {

// The folder `name` there. None: it isn't there, which is said.
inline std::optional<std::filesystem::path> shared_files(const char* name) {
  const char* set = std::getenv("TERACELL_SHARED");
  const std::filesystem::path folder = std::filesystem::path(set ? set : "../shared") / name;  // from the top of the checkout
  if (std::filesystem::exists(folder)) return folder;
  std::cout << "no files in " << folder << ": set TERACELL_SHARED to test real ones\n";
  return std::nullopt;
}

}  // namespace teracell::testing
