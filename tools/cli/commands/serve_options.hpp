// What `teracell serve` is told on its command line.
#pragma once
#include "server/http/options.hpp"
#include "store/base/error.hpp"
#include "store/remote/sources.hpp"
#include "tools/cli/command.hpp"

namespace teracell::cli {

struct ServeArguments {
  std::vector<std::string> grids, allow_hosts, allow_origins;
  std::string host = "127.0.0.1", cache = "256M", base_path, token_file, web, log = "text";
  int port = 8080, threads = 0;
  uint64_t max_pixels = uint64_t{1} << 26, max_connections = 1024;
  SourceOptions source;
  double recheck = 60;
  double request_timeout = 10, idle_timeout = 60, drain_timeout = 10, work_timeout = 60;
  std::vector<std::string> trusted_proxies;
};

void add_serve_options(CLI::App& app, ServeArguments& o);

// Without what depends on the descriptors that the system allows. Throws UsageError, and IoError for a token that can't be read.
server::ListenerOptions listener_options(const ServeArguments& o);

// What make() returns. The library's messages begin with the file; people also want to know which option named it.
template <class Make>
auto for_option(const char* option, const Make& make) try {
  return make();
} catch (const IoError& e) {
  throw IoError(fmt::format("{} {}", option, e.what()));
} catch (const UsageError& e) {
  throw UsageError(fmt::format("{} {}", option, e.what()));
}

}  // namespace teracell::cli
