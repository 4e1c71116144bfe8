// teracell serve: grids over HTTP.
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "server/http/clients.hpp"
#include "server/http/listener.hpp"
#include "server/http/token.hpp"
#include "server/http/wire.hpp"
#include "server/prefetch.hpp"
#include "server/routes.hpp"
#include "server/web.hpp"
#include "store/error.hpp"
#include "store/text.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/notice.hpp"

namespace teracell {
namespace {

struct ServeArguments {
  std::vector<std::string> grids;
  std::string host = "127.0.0.1", cache = "256M", base_path, token_file, web, log = "text";
  int port = 8080, threads = 0;
  uint64_t max_pixels = uint64_t{1} << 26, max_connections = 1024;
  double request_timeout = 10, idle_timeout = 60, drain_timeout = 10, work_timeout = 60;
  std::vector<std::string> trusted_proxies;
};

std::chrono::milliseconds milliseconds(double seconds) { return std::chrono::milliseconds(std::llround(seconds * 1000)); }

CLI::Validator in_range(double lo, double hi) {
  return CLI::Validator(
      [=](std::string& found) {
        double value;
        return CLI::detail::lexical_cast(found, value) && value >= lo && value <= hi
                   ? ""
                   : fmt::format("expected {:.15g} to {:.15g}, found '{}'", lo, hi, found);
      },
      "");
}

// What make() returns. The library's messages begin with the file; people also want to know which option named it.
template <class Make>
auto for_option(const char* option, const Make& make) try {
  return make();
} catch (const IoError& e) {
  throw IoError(fmt::format("{} {}", option, e.what()));
} catch (const UsageError& e) {
  throw UsageError(fmt::format("{} {}", option, e.what()));
}

std::string base_path(std::string text) {
  while (text.ends_with('/')) text.pop_back();
  if (!is_base_path(text))
    throw UsageError(fmt::format("--base-path: expected a path like /grids, of letters, digits and . _ ~ -, found '{}'", text));
  return text;
}

// Allows descriptors for all connections and for the grids, as far as the system permits.
void raise_descriptor_limit(uint64_t connections) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  const rlim_t wanted = std::min<rlim_t>(limit.rlim_max, connections + 4096);
  if (limit.rlim_cur < wanted) limit.rlim_cur = wanted, setrlimit(RLIMIT_NOFILE, &limit);
}

Listener listen_with(const ListenerOptions& options, Handler handler, Metrics& metrics, AccessLog& log) try {
  return Listener(options, std::move(handler), metrics, log);
} catch (const IoError& e) {
  throw IoError(fmt::format("{} (--host, --port)", e.what()));
}

ServerState state_of(Service& service, const AccessLog& log) {
  const auto cache = [](const char* name, const auto& counts) { return CacheState{name, counts.bytes, counts.limit, counts.hits, counts.misses}; };
  const Service::Counters& c = service.counters();
  return {{cache("chunks", service.chunks().counts()), cache("index", service.index().counts()), cache("answers", service.answers().counts())},
          service.grids().all().size(),
          c.reads,
          c.bytes,
          c.damaged,
          log.dropped(),
          resident_bytes(),
          TERACELL_VERSION};
}

void run(const ServeArguments& o) {
  if (o.host.empty()) throw UsageError("--host: expected an address of this machine, found ''");  // Asio would listen at all of them
  ListenerOptions listen;
  listen.host = o.host;
  listen.port = static_cast<uint16_t>(o.port);
  listen.threads = threads_or_all(o.threads);
  listen.base_path = base_path(o.base_path);
  if (!o.token_file.empty()) listen.token = for_option("--token-file", [&] { return read_token(o.token_file); });
  listen.max_connections = o.max_connections;
  listen.max_connections_per_client = std::max<uint64_t>(1, o.max_connections / 4);
  listen.trusted_proxies = o.trusted_proxies;
  listen.work_timeout = milliseconds(o.work_timeout);
  listen.request_timeout = milliseconds(o.request_timeout);
  listen.idle_timeout = milliseconds(o.idle_timeout);
  listen.drain_timeout = milliseconds(o.drain_timeout);
  listen.stop_on_signals = true;
  raise_descriptor_limit(o.max_connections);
  // One thread allocates a chunk, another frees it. With one heap per thread a cache of 256 MB took 120 MB more than its size;
  // with a single heap it takes 60 MB more, and tiles come as fast.
  mallopt(M_ARENA_MAX, 1);

  AccessLog log(o.log == "none" ? LogFormat::kNone : o.log == "json" ? LogFormat::kJson : LogFormat::kText, STDERR_FILENO);
  const auto note = [&](const std::string& message) { log.note(printable(message)); };
  Service service({{o.grids.begin(), o.grids.end()}, parse_size(o.cache, "--cache"), o.max_pixels, listen.token.empty(), note});
  Prefetch prefetch([&](const Request& request) {
    if (!service.is_cached(request)) handle(service, request);
  });
  Metrics metrics;
  const Page page = o.web.empty() ? Page(embedded_page()) : for_option("--web", [&] { return Page(o.web); });
  const Handler routes = with_operations(with_prefetch(handler_of(service), prefetch), metrics, [&] { return state_of(service, log); });
  const Body licences = body_of(std::string(notice()));
  Listener listener = listen_with(listen, with_page(with_text(routes, "/NOTICE", licences), page), metrics, log);
  if (!listener.loopback() && listen.token.empty())
    note(fmt::format("warning: anybody who can reach {} can read these grids: give a --token-file, or put a server in front that asks for a password",
                     o.host));
  say(fmt::format("teracell: serving {} at {}", plural(service.grids().all().size(), "grid"), listener.url()));
  std::fflush(stdout);
  if (listener.run()) return;
  note(fmt::format("warning: stopped after {} s while requests were still under way", o.drain_timeout));
  log.finish();
  _exit(0);  // the threads that still make answers can't be interrupted
}

}  // namespace

Run setup_serve(CLI::App& app) {
  const auto o = std::make_shared<ServeArguments>();
  app.add_option("grids", o->grids, ".tcell files, and folders: all .tcell files in them are served, also those that are added later")->required();
  app.add_option("--host", o->host, "the address to listen at (default 127.0.0.1: this machine only)");
  app.add_option("--port", o->port, "the port to listen at (default 8080); 0: any that is free")->check(in_range(0, 65535));
  add_threads(app, o->threads);
  app.add_option("--cache", o->cache,
                 "memory for decoded chunks and index pages of all grids (default 256M); encoded answers take up to an eighth of this on top");
  app.add_option("--max-pixels", o->max_pixels, "the most pixels of one picture (default 67108864)")->check(in_range(1, 1e12));
  app.add_option("--base-path", o->base_path, "serve below this path, such as /grids (default: at the root)");
  app.add_option("--token-file", o->token_file, "a file whose first line is the token that clients must send (Authorization: Bearer TOKEN)");
  app.add_option("--web", o->web, "serve the page at / from this folder instead of the program's own, for work on it");
  app.add_option("--log", o->log, "one line per request on stderr: text (default), json or none")->check(one_of({"text", "json", "none"}));
  app.add_option("--max-connections", o->max_connections, "the most connections at once (default 1024); a client gets a quarter of them")
      ->check(in_range(1, 1e6));
  app.add_option("--trust-proxy", o->trusted_proxies,
                 "the address of a proxy that names the clients (X-Forwarded-For), so that each of them gets its own share; repeatable")
      ->check(CLI::Validator(
          [](std::string& found) { return last_forwarded(found).empty() ? fmt::format("expected an address, found '{}'", found) : ""; }, ""))
      ->type_size(1)
      ->allow_extra_args(false);
  app.add_option("--work-timeout", o->work_timeout, "seconds of work after which a request is refused as too dear (default 60)")
      ->check(in_range(0.1, 86400));
  app.add_option("--request-timeout", o->request_timeout, "seconds that a client may take to send a request (default 10)")
      ->check(in_range(0.1, 86400));
  app.add_option("--idle-timeout", o->idle_timeout, "seconds that a connection is kept between requests (default 60)")->check(in_range(0.1, 86400));
  app.add_option("--drain-timeout", o->drain_timeout, "seconds that requests under way are given when it is stopped (default 10)")
      ->check(in_range(0, 86400));
  app.footer(
      "SIGTERM or SIGINT stops the server: requests under way are answered first. A second signal ends it at once.\n"
      "Examples:\n  teracell serve g.tcell\n  teracell serve grids/ --host 0.0.0.0 --token-file token --log json");
  return [o] { run(*o); };
}

}  // namespace teracell
