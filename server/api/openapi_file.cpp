// The assembler takes the file as it is. CMakeLists.txt says where the file is, and that this source depends on it.
// Its labels are hidden for the reason that tools/cli/notice.cpp gives.
#include "server/api/openapi.hpp"

asm(".pushsection .rodata\n"
    "teracell_openapi:\n"
    ".incbin \"" TERACELL_TAKEN
    "\"\n"
    "teracell_openapi_end:\n"
    ".popsection");
extern "C" [[gnu::visibility("hidden")]] const char teracell_openapi[] asm("teracell_openapi");
extern "C" [[gnu::visibility("hidden")]] const char teracell_openapi_end[] asm("teracell_openapi_end");

namespace teracell::server {

std::string_view openapi_file() { return {teracell_openapi, teracell_openapi_end}; }

}  // namespace teracell::server
