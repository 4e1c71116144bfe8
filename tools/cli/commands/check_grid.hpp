// What `check` and `mesh --check` share.
#pragma once
#include "store/check/finding.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {

// Looks through a grid, and keeps what is found in a file unless its name is empty.
Findings check_grid(const GridArgument& grid, const std::filesystem::path& output, int threads, const std::string& progress);
void say_findings(const std::string& grid, const Findings& findings);

}  // namespace teracell::cli
