// What `check` and `mesh --check` share.
#pragma once
#include "store/check/check.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {

// Looks through a grid, and keeps what is found in a file unless its name is empty.
Findings check_grid(const GridArgument& grid, const std::filesystem::path& output, const CheckOptions& options, const std::string& progress);
void say_findings(const std::string& grid, const Findings& findings);

}  // namespace teracell::cli
