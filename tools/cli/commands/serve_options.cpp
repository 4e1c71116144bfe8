#include "tools/cli/commands/serve_options.hpp"

#include <cmath>

#include <fmt/format.h>

#include "server/http/clients.hpp"
#include "server/http/host.hpp"
#include "server/http/token.hpp"
#include "server/http/wire.hpp"

namespace teracell::cli {
namespace {

std::chrono::milliseconds milliseconds(double seconds) { return std::chrono::milliseconds(std::llround(seconds * 1000)); }

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

}  // namespace

void add_serve_options(CLI::App& app, ServeArguments& o) {
  app.add_option("grids", o.grids,
                 ".tcell files; folders: all .tcell files in them are served, also those that are added later; addresses: https://HOST/PATH or "
                 "s3://BUCKET/KEY")
      ->required();
  app.add_option("--host", o.host, "the address to listen at (default 127.0.0.1: this machine only)");
  app.add_option("--port", o.port, "the port to listen at (default 8080); 0: any that is free")->check(in_range(0, 65535));
  add_threads(app, o.threads);
  app.add_option("--cache", o.cache,
                 "memory for decoded chunks and index pages of all grids (default 256M); encoded answers take up to an eighth of this on top");
  add_source_options(app, o.source);
  app.add_option("--recheck", o.recheck, "seconds after which the host of an address is asked again whether the grid was replaced (default 60)")
      ->check(in_range(1, 86400));
  app.add_option("--max-pixels", o.max_pixels, "the most pixels of one picture (default 67108864)")->check(in_range(1, 1e12));
  app.add_option("--base-path", o.base_path, "serve below this path, such as /grids (default: at the root)");
  app.add_option("--token-file", o.token_file, "a file whose first line is the token that clients must send (Authorization: Bearer TOKEN)");
  app.add_option("--allow-host", o.allow_hosts,
                 "a name that clients may use for this server; repeatable, * for any (default: loopback names such as localhost; any with a token or "
                 "another --host)")
      ->allow_extra_args(false);
  app.add_option("--allow-origin", o.allow_origins,
                 "an origin such as https://example.org whose web pages may read the grids; repeatable, * for any (default: as for --allow-host)")
      ->allow_extra_args(false);
  app.add_option("--web", o.web, "serve the page at / from this folder instead of the program's own, for work on it");
  app.add_option("--log", o.log, "one line per request on stderr: text (default), json or none")->check(one_of({"text", "json", "none"}));
  app.add_option("--max-connections", o.max_connections, "the most connections at once (default 1024); a client gets a quarter of them")
      ->check(in_range(1, 1e6));
  app.add_option("--trust-proxy", o.trusted_proxies,
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
  app.add_option("--work-timeout", o.work_timeout, "seconds of work after which a request is refused as too dear (default 60)")
      ->check(in_range(0.1, 86400));
  app.add_option("--request-timeout", o.request_timeout, "seconds that a client may take to send a request (default 10)")
      ->check(in_range(0.1, 86400));
  app.add_option("--idle-timeout", o.idle_timeout, "seconds that a connection is kept between requests (default 60)")->check(in_range(0.1, 86400));
  app.add_option("--drain-timeout", o.drain_timeout, "seconds that requests under way are given when it is stopped (default 10)")
      ->check(in_range(0, 86400));
}

server::ListenerOptions listener_options(const ServeArguments& o) {
  if (o.host.empty()) throw UsageError("--host: expected an address of this machine, found ''");  // Asio would listen at all of them
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
  return listen;
}

}  // namespace teracell::cli
