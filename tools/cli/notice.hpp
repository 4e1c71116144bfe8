// The file NOTICE: which software of others is in the program. `teracell --licenses` prints it, and the server answers it.
#pragma once
#include <string_view>

namespace teracell::cli {

std::string_view notice();

}  // namespace teracell::cli
