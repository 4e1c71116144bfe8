#include "store/remote/libcurl.hpp"

#include <dlfcn.h>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::inline store {
namespace {

LibCurl load() {
  void* library = dlopen("libcurl.so.4", RTLD_NOW | RTLD_LOCAL);
  if (library == nullptr) throw IoError(fmt::format("addresses need libcurl (Debian: libcurl4): {}", dlerror()));
  LibCurl found{};
#define FOUND(name)                                                                   \
  found.name = reinterpret_cast<decltype(found.name)>(dlsym(library, "curl_" #name)); \
  if (found.name == nullptr) throw IoError("libcurl is older than 7.80: it has no function curl_" #name);
  TERACELL_CURL_FUNCTIONS(FOUND)
#undef FOUND
  if (found.global_init(CURL_GLOBAL_DEFAULT) != CURLE_OK) throw IoError("libcurl can't be initialised");
  return found;
}

}  // namespace

const LibCurl& libcurl() {
  static const LibCurl loaded = load();
  return loaded;
}

}  // namespace teracell::store
