// NOTICE, as `teracell --licenses` prints it and the server answers it: what others have written that is in the program.
#pragma once
#include <string_view>

namespace teracell {

std::string_view notice();

}  // namespace teracell
