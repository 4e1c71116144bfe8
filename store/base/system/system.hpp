// What is asked of the operating system beyond POSIX: portable.hpp says what each function does. With -DTERACELL_PORTABLE=ON Linux is taken for any
 // system.
#pragma once
#include "store/base/system/linux_only.hpp"

namespace teracell::inline store {

#if defined(__linux__) && !defined(TERACELL_PORTABLE)
namespace system = linux_only;
#else
namespace system = portable;
#endif

}  // namespace teracell::store
