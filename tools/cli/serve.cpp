// teracell serve: grids over HTTP.
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "server/http/listener.hpp"
#include "server/prefetch.hpp"
#include "server/routes.hpp"
#include "server/web.hpp"
#include "server/wire.hpp"
#include "store/error.hpp"
#include "store/text.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/notice.hpp"

namespace teracell {
namespace {

struct Options {
  std::vector<std::string> grids;
  std::string host = "127.0.0.1", cache = "256M", base_path, token_file, web, log = "text";
  int port = 8080, threads = 0;
  uint64_t max_pixels = uint64_t{1} << 26, max_connections = 1024;
  double request_timeout = 10, idle_timeout = 60, drain_timeout = 10;
};

std::chrono::milliseconds milliseconds(double seconds) { return std::chrono::milliseconds(std::llround(seconds * 1000)); }

CLI::Validator in_range(double lo, double hi) {
  return CLI::Validator([=](std::string& found) {
    double value;
    return CLI::detail::lexical_cast(found, value) && value >= lo && value <= hi ? "" : fmt::format("expected {:.15g} to {:.15g}, found '{}'", lo, hi, found);
  }, "");
}

// The first line, without spaces around it.
std::string token_in(const std::string& file) {
  std::ifstream in(file);
  std::string token;
  if (in) in.peek();  // a folder can be opened, not read
  if (in.bad() || !in.is_open()) throw IoError(fmt::format("--token-file {}: can't be read: {}", file, std::generic_category().message(errno)));
  std::getline(in, token);
  while (!token.empty() && std::isspace(static_cast<unsigned char>(token.back()))) token.pop_back();
  const auto is_bad = [](char c) { return c <= 0x20 || c >= 0x7f; };
  if (token.empty() || token.size() > 4096 || std::ranges::any_of(token, is_bad))
    throw UsageError(fmt::format("--token-file {}: expected a first line of 1 to 4096 printable ASCII characters without spaces, found {}", file,
                                 token.empty() ? "an empty one" : token.size() > 4096 ? fmt::format("{} characters", token.size()) : "other ones"));
  return token;
}

std::string base_path(std::string text) {
  while (text.ends_with('/')) text.pop_back();
  if (!is_base_path(text)) throw UsageError(fmt::format("--base-path: expected a path like /grids, of letters, digits and . _ ~ -, found '{}'", text));
  return text;
}

// As many descriptors as the connections need, and the grids; as far as the system lets us.
void raise_descriptor_limit(uint64_t connections) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  const rlim_t wanted = std::min<rlim_t>(limit.rlim_max, connections + 4096);
  if (limit.rlim_cur < wanted) limit.rlim_cur = wanted, setrlimit(RLIMIT_NOFILE, &limit);
}

// The service as the listener wants it: neighbours of what is looked at are fetched ahead while nothing else is being made.
Handler handler_of(Service& service, Prefetch& prefetch) {
  return {[&](const Request& request) {
            std::optional<Response> r = handle_at_once(service, request);
            if (r) prefetch.answered(request, *r);
            return r;
          },
          [&](const Request& request) {
            struct UnderWay {
              Prefetch& prefetch;
              explicit UnderWay(Prefetch& p) : prefetch(p) { prefetch.begin(); }
              ~UnderWay() { prefetch.end(); }
            };
            Response r = [&] {
              const UnderWay under_way(prefetch);
              return handle(service, request);
            }();
            prefetch.answered(request, r);
            return r;
          }};
}

Page page_of(const std::string& folder) try {
  return folder.empty() ? Page(embedded_page()) : Page(folder);
} catch (const IoError& e) {
  throw IoError(fmt::format("--web {}", e.what()));
}

ServerState state_of(Service& service, const AccessLog& log) {
  const auto cache = [](const char* name, const auto& counts) { return CacheState{name, counts.bytes, counts.limit, counts.hits, counts.misses}; };
  const Service::Counters& c = service.counters();
  return {{cache("chunks", service.chunks().counts()), cache("index", service.index().counts()), cache("answers", service.answers().counts())},
          service.grids().all().size(), c.reads, c.bytes, c.damaged, log.dropped(), resident_bytes(), TERACELL_VERSION};
}

void run(const Options& o) {
  if (o.host.empty()) throw UsageError("--host: expected an address of this machine, found ''");  // which would be all of them
  ListenerOptions listen;
  listen.host = o.host;
  listen.port = static_cast<uint16_t>(o.port);
  listen.threads = threads_or_all(o.threads);
  listen.base_path = base_path(o.base_path);
  if (!o.token_file.empty()) listen.token = token_in(o.token_file);
  listen.max_connections = o.max_connections;
  listen.request_timeout = milliseconds(o.request_timeout);
  listen.idle_timeout = milliseconds(o.idle_timeout);
  listen.drain_timeout = milliseconds(o.drain_timeout);
  listen.stop_on_signals = true;
  raise_descriptor_limit(o.max_connections);
  // Chunks are made by one thread and freed by another: with a heap for each thread a cache of 256 MB took 120 MB more, with
  // one it takes 60, and the tiles come as fast.
  mallopt(M_ARENA_MAX, 1);

  AccessLog log(o.log == "none" ? LogFormat::kNone : o.log == "json" ? LogFormat::kJson : LogFormat::kText, STDERR_FILENO);
  const auto note = [&](const std::string& message) { log.note(printable(message)); };
  Service service({{o.grids.begin(), o.grids.end()}, parse_size(o.cache, "--cache"), o.max_pixels, listen.token.empty(), note});
  Prefetch prefetch([&](const Request& request) {
    if (!service.keeps(request)) handle(service, request);
  });
  Metrics metrics;
  const Page page = page_of(o.web);
  const Handler routes = with_operations(handler_of(service, prefetch), metrics, [&] { return state_of(service, log); });
  const Body licences = body_of(std::string(notice()));
  Listener listener(listen, with_page(with_text(routes, "/NOTICE", licences), page), metrics, log);
  if (!listener.loopback() && listen.token.empty())
    note(fmt::format("warning: anybody who reaches {} can read these grids: give a --token-file, or put a server that asks in front", o.host));
  say(fmt::format("teracell: serving {} at {}", plural(service.grids().all().size(), "grid"), listener.url()));
  std::fflush(stdout);
  if (listener.run()) return;
  note(fmt::format("warning: stopped with requests under way after {} s", o.drain_timeout));
  log.finish();
  _exit(0);  // what is still being made can't be interrupted
}

}  // namespace

Run setup_serve(CLI::App& app) {
  const auto o = std::make_shared<Options>();
  app.add_option("grids", o->grids, ".tcell files, and folders whose .tcell files are served, new ones too")->required();
  app.add_option("--host", o->host, "the address to listen at (default 127.0.0.1: this machine only)");
  app.add_option("--port", o->port, "the port (default 8080); 0: any that is free")->check(in_range(0, 65535));
  add_threads(app, o->threads);
  app.add_option("--cache", o->cache, "memory for decoded chunks and index pages of all grids, and an eighth as much for answers (default 256M)");
  app.add_option("--max-pixels", o->max_pixels, "of one picture (default 67108864)")->check(in_range(1, 1e12));
  app.add_option("--base-path", o->base_path, "serve below this path");
  app.add_option("--token-file", o->token_file, "its first line is the token that clients must bear (Authorization: Bearer TOKEN)");
  app.add_option("--web", o->web, "the page at / from this folder, instead of the program's own: for working on it");
  app.add_option("--log", o->log, "a line a request on stderr: text (default), json, none")->check(one_of({"text", "json", "none"}));
  app.add_option("--max-connections", o->max_connections, "at once (default 1024)")->check(in_range(1, 1e6));
  app.add_option("--request-timeout", o->request_timeout, "seconds that a client may take to send a request (default 10)")->check(in_range(0.1, 86400));
  app.add_option("--idle-timeout", o->idle_timeout, "seconds that a connection is kept between requests (default 60)")->check(in_range(0.1, 86400));
  app.add_option("--drain-timeout", o->drain_timeout, "seconds that requests under way are given when it is stopped (default 10)")->check(in_range(0, 86400));
  app.footer("SIGTERM or SIGINT stops it: requests under way are answered first. A second one ends it at once.\n"
             "Examples:\n  teracell serve g.tcell\n  teracell serve grids/ --host 0.0.0.0 --token-file token --log json");
  return [o] { run(*o); };
}

}  // namespace teracell
