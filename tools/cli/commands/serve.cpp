// teracell serve: grids over HTTP.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>

#include <fmt/format.h>

#include "server/api/routes.hpp"
#include "server/http/listener.hpp"
#include "server/http/token.hpp"
#include "server/operations/prefetch.hpp"
#include "server/page/web.hpp"
#include "server/service/descriptors.hpp"
#include "server/service/grids_watch.hpp"
#include "store/base/system/system.hpp"
#include "store/text/text.hpp"
#include "tools/cli/commands/serve_options.hpp"
#include "tools/cli/notice.hpp"

namespace teracell::cli {
namespace {

constexpr size_t kBlocks = size_t{256} << 20;  // memory for what was read from addresses
constexpr uint64_t kMoreThreads = 3;           // that read grids: at the start, to ask hosts, and ahead of requests

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
  return {service.caches(), service.grids().all().size(), c.reads, c.bytes, c.damaged, log.dropped(), system::resident_bytes(), TERACELL_VERSION};
}

// How many descriptors would serve the grids and the connections best.
server::DescriptorShares wanted_descriptors(const ServeArguments& o, int threads) {
  const bool fetches = std::ranges::any_of(o.grids, is_address);
  const uint64_t fetching = fetches ? kMostFetches * (static_cast<uint64_t>(threads) + kMoreThreads) : 0;
  return server::wanted_descriptors(o.max_connections, server::count_grids({o.grids.begin(), o.grids.end()}), static_cast<uint64_t>(threads),
                                    system::open_descriptors() + fetching);
}

void run(const ServeArguments& o) {
  const bool with_terminal = ends_with_terminal();
  server::ListenerOptions listen = listener_options(o);
  const server::DescriptorShares wanted = wanted_descriptors(o, listen.threads), shares = server::share_descriptors(wanted);
  listen.max_connections = shares.connections;
  listen.max_connections_per_client = std::max<uint64_t>(1, listen.max_connections / 4);
  // One thread allocates a chunk, another frees it. With one heap per thread a cache of 256 MB took 120 MB more than its size;
  // with a single heap it takes 60 MB more, and tiles come as fast.
  system::limit_heaps(1);

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
  server::Service service(
      {{o.grids.begin(), o.grids.end()}, parse_size(o.cache, "--cache"), o.max_pixels, shares.files, listen.token.empty(), note, source});
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
  add_serve_options(app, *o);
  app.footer(
      "SIGTERM or SIGINT stops the server: requests under way are answered first. A second signal ends it at once.\n"
      "SIGHUP makes it look at all files anew, and read the token again.\n"
      "Examples:\n  teracell serve g.tcell\n  teracell serve grids/ --host 0.0.0.0 --token-file token --log json");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
