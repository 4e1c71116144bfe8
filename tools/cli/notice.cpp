// The assembler takes the file as it is, like the files of the page. CMakeLists.txt says where the file is, and that this
// source depends on it.
#include "tools/cli/notice.hpp"

asm(".pushsection .rodata\n"
    "teracell_notice:\n"
    ".incbin \"" TERACELL_TAKEN
    "\"\n"
    "teracell_notice_end:\n"
    ".popsection");
// Hidden: what might come from another library is found through a table, in which GNU ld for arm64 takes all labels of a section for its first.
extern "C" [[gnu::visibility("hidden")]] const char teracell_notice[] asm("teracell_notice");
extern "C" [[gnu::visibility("hidden")]] const char teracell_notice_end[] asm("teracell_notice_end");

namespace teracell::cli {

std::string_view notice() { return {teracell_notice, teracell_notice_end}; }

}  // namespace teracell::cli
