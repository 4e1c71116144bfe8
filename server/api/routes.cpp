#include "server/api/routes.hpp"

#include "server/api/api.hpp"
#include "server/api/openapi.hpp"
#include "server/page/start_page.hpp"
#include "server/protocols/protocols.hpp"

namespace teracell::server {
namespace {

Response plain(const char* route, const char* type, std::string text) {
  Response r;
  r.route = route;
  r.content_type = type;
  r.cache_control = "no-cache";
  r.body = body_of(std::move(text));
  return r;
}

Response route(Service& service, const Request& request) {
  const Target target = parse_target(request.target);
  const std::string& first = target.path[0];
  if (target.path.size() == 1 && first.empty()) return plain("page", "text/html; charset=utf-8", start_page(service, request));
  if (target.path.size() == 1 && first == "openapi.json") return plain("openapi", "application/json", openapi_json(request));
  if (first == "api") return answer_api(service, request, target, protocols());
  for (const Protocol& p : protocols())
    if (first == p.prefix) return p.serve({service, request, target, p.route});
  throw no_such_address(request);
}

Cost cost_of(const Request& request) try {
  const Target target = parse_target(request.target);
  for (const Protocol& p : protocols())
    if (target.path[0] == p.prefix) return p.dear ? Cost::kDear : Cost::kCheap;
  return target.path[0] == "api" ? cost_of_api(target) : Cost::kCheap;
} catch (const HttpError&) {
  return Cost::kCheap;  // handle() refuses it
}

}  // namespace

std::optional<Response> handle_at_once(Service& service, const Request& request) { return service.from_cache(request); }

Response handle(Service& service, const Request& request) {
  return answered(service, [&] { return route(service, request); });
}

Handler handler_of(Service& service) {
  return {[&service](const Request& request) { return handle_at_once(service, request); },
          [&service](const Request& request) { return handle(service, request); },
          {},
          cost_of};
}

}  // namespace teracell::server
