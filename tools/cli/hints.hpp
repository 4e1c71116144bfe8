// Errors of the libraries in the words of the command line. A library names no option: it says which field is wrong, or what would help.
#pragma once
#include <string>

#include "store/base/error.hpp"

namespace teracell::cli {

// The message, with the option in place of the field, and with what to type.
std::string with_hint(const Error& e);

}  // namespace teracell::cli
