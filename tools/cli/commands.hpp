// The commands of the program.
#pragma once
#include <vector>

#include "tools/cli/command.hpp"

namespace teracell::cli {

struct Command {
  std::string name, summary;
  Run (*setup)(CLI::App&);
};

// In the order of the help.
const std::vector<Command>& commands();

}  // namespace teracell::cli
