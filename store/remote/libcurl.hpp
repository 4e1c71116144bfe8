// libcurl, loaded when the first address is opened. Debian's libcurl loads 30 other libraries, for directory services among others;
// linked, it would make every command on a file start later.
#pragma once
#define CURL_DISABLE_TYPECHECK  // its macros can't be used with pointers to functions
#include <curl/curl.h>

// clang-format off
#define TERACELL_CURL_FUNCTIONS(f) \
  f(global_init) f(free) f(slist_append) f(slist_free_all) \
  f(easy_init) f(easy_cleanup) f(easy_reset) f(easy_setopt) f(easy_getinfo) f(easy_strerror) \
  f(multi_init) f(multi_setopt) f(multi_cleanup) f(multi_add_handle) f(multi_remove_handle) f(multi_perform) f(multi_poll) f(multi_info_read) f(multi_strerror) \
  f(url) f(url_cleanup) f(url_set) f(url_get) f(url_strerror)
// clang-format on

namespace teracell::inline store {

struct LibCurl {
#define DECLARED(name) decltype(&::curl_##name) name;
  TERACELL_CURL_FUNCTIONS(DECLARED)
#undef DECLARED
};

// Throws IoError when libcurl is not installed. Threads may call it.
const LibCurl& libcurl();

}  // namespace teracell::store
