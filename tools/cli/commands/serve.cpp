// teracell serve: grids over HTTP.
#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>

#include <fmt/format.h>

#include "server/api/routes.hpp"
#include "server/http/clients.hpp"
#include "server/http/host.hpp"
#include "server/http/listener.hpp"
#include "server/http/token.hpp"
#include "server/http/wire.hpp"
#include "server/operations/prefetch.hpp"
#include "server/page/web.hpp"
#include "server/service/descriptors.hpp"
#include "server/service/grids_watch.hpp"
#include "store/base/error.hpp"
#include "store/remote/sources.hpp"
#include "store/text/text.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/notice.hpp"

namespace teracell::cli {
namespace {

constexpr size_t kBlocks = size_t{256} << 20;  // memory for what was read from addresses
constexpr uint64_t kMoreThreads = 3;           // that read grids: at the start, to ask hosts, and ahead of requests

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
  if (!server::is_base_path(text))
    throw UsageError(fmt::format("--base-path: expected a path like /grids, of letters, digits and . _ ~ -, found '{}'", text));
  return text;
}

std::vector<std::string> each_is(const std::vector<std::string>& given, bool (*good)(std::string_view), const char* expected) {
  for (const std::string& g : given)
    if (g != "*" && !good(g)) throw UsageError(fmt::format("{}, found '{}'", expected, g));
  return given;
}

uint64_t open_descriptors() {
  std::error_code ignored;
  const std::filesystem::directory_iterator all("/proc/self/fd", ignored);
  return static_cast<uint64_t>(std::distance(begin(all), end(all)));
}

// Raises the limit of descriptors as far as it is useful and the system permits.
server::DescriptorShares share_descriptors(const server::DescriptorShares& wanted) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return wanted;
  const rlimit raised{std::min<rlim_t>(limit.rlim_max, wanted.all()), limit.rlim_max};
  if (limit.rlim_cur < raised.rlim_cur && setrlimit(RLIMIT_NOFILE, &raised) == 0) limit = raised;
  return allowed_descriptors(wanted, limit.rlim_cur);
}

bool has_terminal() {
  const int terminal = open("/dev/tty", O_RDONLY | O_NOCTTY | O_CLOEXEC | O_NONBLOCK);
  return terminal >= 0 && close(terminal) == 0;
}

// Ignores SIGHUP and SIGUSR1 until the listener takes the first. Returns whether the server has to end with its terminal.
bool ends_with_terminal() {
  std::signal(SIGUSR1, SIG_IGN);
  return std::signal(SIGHUP, SIG_IGN) != SIG_IGN && has_terminal();  // nohup ignores it
}

server::Listener listen_with(const server::ListenerOptions& options, server::Handler handler, server::Metrics& metrics, server::AccessLog& log) try {
  return server::Listener(options, std::move(handler), metrics, log);
} catch (const IoError& e) {
  throw IoError(fmt::format("{} (--host, --port)", e.what()));
}

server::ServerState state_of(server::Service& service, const server::AccessLog& log) {
  const server::ReadCounters& c = service.counters();
  return {service.caches(), service.grids().all().size(), c.reads, c.bytes, c.damaged, log.dropped(), server::resident_bytes(), TERACELL_VERSION};
}

void run(const ServeArguments& o) {
  if (o.host.empty()) throw UsageError("--host: expected an address of this machine, found ''");  // Asio would listen at all of them
  const bool with_terminal = ends_with_terminal();
  server::ListenerOptions listen;
  listen.host = o.host;
  listen.port = static_cast<uint16_t>(o.port);
  listen.threads = threads_or_all(o.threads);
  listen.base_path = base_path(o.base_path);
  if (!o.token_file.empty()) listen.token = for_option("--token-file", [&] { return server::read_token(o.token_file); });
  listen.allowed_hosts = each_is(o.allow_hosts, server::is_host_name, "--allow-host: expected a host name without a port, or *");
  listen.allowed_origins = each_is(o.allow_origins, server::is_web_origin, "--allow-origin: expected an origin like https://example.org, or *");
  listen.host_hint = ": give --allow-host NAME to teracell serve, if this name is right";
  for (const std::string& proxy : o.trusted_proxies) listen.trusted_proxies.push_back(server::last_forwarded(proxy));
  listen.work_timeout = milliseconds(o.work_timeout);
  listen.request_timeout = milliseconds(o.request_timeout);
  listen.idle_timeout = milliseconds(o.idle_timeout);
  listen.drain_timeout = milliseconds(o.drain_timeout);
  listen.stop_on_signals = true;
  const std::vector<std::filesystem::path> named(o.grids.begin(), o.grids.end());
  const auto addresses = static_cast<uint64_t>(std::ranges::count_if(o.grids, is_address));
  const uint64_t fetching = addresses > 0 ? kMostFetches * (static_cast<uint64_t>(listen.threads) + kMoreThreads) : 0;
  const server::DescriptorShares wanted =
      server::wanted_descriptors(o.max_connections, server::count_grids(named), static_cast<uint64_t>(listen.threads), open_descriptors() + fetching);
  const server::DescriptorShares shares = share_descriptors(wanted);
  listen.max_connections = shares.connections;
  listen.max_connections_per_client = std::max<uint64_t>(1, listen.max_connections / 4);
  // One thread allocates a chunk, another frees it. With one heap per thread a cache of 256 MB took 120 MB more than its size;
  // with a single heap it takes 60 MB more, and tiles come as fast.
  mallopt(M_ARENA_MAX, 1);

  server::AccessLog log(o.log == "none"   ? server::LogFormat::kNone
                        : o.log == "json" ? server::LogFormat::kJson
                                          : server::LogFormat::kText,
                        STDERR_FILENO);
  const auto note = [&](const std::string& message) { log.note(printable(message)); };
  if (shares.connections < wanted.connections)
    note(fmt::format("warning: at most {} connections at once instead of {}, since the system allows {} descriptors: raise the limit (ulimit -n {})",
                     shares.connections, wanted.connections, shares.all(), wanted.all()));
  if (!o.token_file.empty() && server::others_can_read(o.token_file))
    note(fmt::format("warning: --token-file {}: other users of this machine can read it: chmod 600 {}", o.token_file, o.token_file));
  SourceOptions source = o.source;
  source.blocks = make_block_cache(kBlocks);
  server::Service service({named, parse_size(o.cache, "--cache"), o.max_pixels, shares.files, listen.token.empty(), note, source});
  server::GridsWatch watch(service.grids(), o.recheck);
  server::Listener* listening = nullptr;
  listen.on_hangup = [&] {
    watch.look_soon();
    if (!o.token_file.empty()) try {
        listening->use_token(server::read_token(o.token_file));
      } catch (const Error& e) {
        note(fmt::format("warning: --token-file {}: the last token stays", e.what()));
      }
    return !with_terminal || has_terminal();
  };
  server::Prefetch prefetch([&](const server::Request& request) {
    if (!service.is_cached(request)) handle(service, request);
  });
  server::Metrics metrics;
  const server::Page page = o.web.empty() ? server::Page(server::embedded_page()) : for_option("--web", [&] { return server::Page(o.web); });
  const server::Handler routes = with_operations(with_prefetch(handler_of(service), prefetch), metrics, [&] { return state_of(service, log); });
  const server::Body licences = server::body_of(std::string(notice()));
  server::Listener listener = listen_with(listen, with_page(with_text(routes, "/NOTICE", licences), page), metrics, log);
  listening = &listener;
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
  app.add_option("grids", o->grids,
                 ".tcell files; folders: all .tcell files in them are served, also those that are added later; addresses: https://HOST/PATH or "
                 "s3://BUCKET/KEY")
      ->required();
  app.add_option("--host", o->host, "the address to listen at (default 127.0.0.1: this machine only)");
  app.add_option("--port", o->port, "the port to listen at (default 8080); 0: any that is free")->check(in_range(0, 65535));
  add_threads(app, o->threads);
  app.add_option("--cache", o->cache,
                 "memory for decoded chunks and index pages of all grids (default 256M); encoded answers take up to an eighth of this on top");
  add_source_options(app, o->source);
  app.add_option("--recheck", o->recheck, "seconds after which the host of an address is asked again whether the grid was replaced (default 60)")
      ->check(in_range(1, 86400));
  app.add_option("--max-pixels", o->max_pixels, "the most pixels of one picture (default 67108864)")->check(in_range(1, 1e12));
  app.add_option("--base-path", o->base_path, "serve below this path, such as /grids (default: at the root)");
  app.add_option("--token-file", o->token_file, "a file whose first line is the token that clients must send (Authorization: Bearer TOKEN)");
  app.add_option("--allow-host", o->allow_hosts,
                 "a name that clients may use for this server; repeatable, * for any (default: loopback names such as localhost; any with a token or "
                 "another --host)")
      ->allow_extra_args(false);
  app.add_option("--allow-origin", o->allow_origins,
                 "an origin such as https://example.org whose web pages may read the grids; repeatable, * for any (default: as for --allow-host)")
      ->allow_extra_args(false);
  app.add_option("--web", o->web, "serve the page at / from this folder instead of the program's own, for work on it");
  app.add_option("--log", o->log, "one line per request on stderr: text (default), json or none")->check(one_of({"text", "json", "none"}));
  app.add_option("--max-connections", o->max_connections, "the most connections at once (default 1024); a client gets a quarter of them")
      ->check(in_range(1, 1e6));
  app.add_option("--trust-proxy", o->trusted_proxies,
                 "the address of a proxy that names the clients (X-Forwarded-For), so that each of them gets its own share; repeatable")
      ->check(CLI::Validator(
          [](std::string& found) {
            return server::last_forwarded(found).empty() || found.find(',') != std::string::npos
                       ? fmt::format("expected an address, found '{}'", found)
                       : "";
          },
          ""))
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
      "SIGHUP makes it look at all files anew, and read the token again.\n"
      "Examples:\n  teracell serve g.tcell\n  teracell serve grids/ --host 0.0.0.0 --token-file token --log json");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
