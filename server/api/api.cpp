#include "server/api/api.hpp"

#include <fmt/format.h>

#include "server/answers/answers.hpp"
#include "store/base/wanted.hpp"
#include "store/check/kept.hpp"
#include "store/text/json_writer.hpp"
#include "store/text/text.hpp"

namespace teracell::server {
namespace {

#define LISTED(name) &name,
constexpr const Answer* kAnswers[] = {TERACELL_ANSWERS(LISTED)};
#undef LISTED

bool is_named(const Answer& answer, const std::string& segment) {
  return answer.name.ends_with('.') ? segment.starts_with(answer.name) : segment == answer.name;
}

// The answer at an address below /api/v1/grids/{id}; null when there is none.
const Answer* answer_at(const Target& target) {
  constexpr size_t kFirst = 4;  // "api", "v1", "grids", id
  const size_t segments = target.path.size() - kFirst;
  for (const Answer* a : kAnswers)
    if (a->segments == segments && (segments == 0 || is_named(*a, target.path[kFirst]))) return a;
  return nullptr;
}

Response list(Service& service, const Target& target, std::span<const Protocol> protocols) {
  target.allow({});
  std::string text;
  JsonWriter out(text);
  out.begin_object().field("schema", 1).key("grids").begin_array();
  for (const auto& grid : service.grids().all()) {
    out.begin_object().field("id", grid->id).field("name", grid->id).field("cells", grid->meta().grid.cells());
    out.field("bytes", grid->reader().file_bytes()).field("hash", grid->hash).field("units", grid->meta().units).field("modified", grid->modified);
    out.field("checked", !grid->path.empty() && has_kept_findings(grid->path, grid->reader()));
    const std::string damage = shortened(grid->reader().damage());
    out.field("damage", damage.empty() ? std::nullopt : std::optional(damage)).key("protocols").begin_array();
    for (const Protocol& p : protocols) out.begin_object().field("title", p.title).field("path", address_of(p, *grid)).end_object();
    out.end_array().end_object();
  }
  out.end_array().key("unreadable").begin_array();
  for (const auto& [id, error] : service.grids().unreadable()) out.begin_object().field("id", id).field("error", error).end_object();
  out.end_array().end_object();
  Response r;
  r.route = "grids";
  r.content_type = kJsonType;
  r.cache_control = "no-cache";
  r.body = body_of(std::move(text));
  return r;
}

}  // namespace

HttpError no_such_address(const Request& request) {
  return not_found(fmt::format("there is nothing at this address: {}/openapi.json lists the addresses", request.prefix));
}

Response answer_api(Service& service, const Request& request, const Target& target, std::span<const Protocol> protocols) {
  const auto& path = target.path;  // "api", "v1", "grids", id, what, ...
  if (path.size() < 3 || path[1] != "v1" || path[2] != "grids") throw no_such_address(request);
  if (path.size() == 3) return list(service, target, protocols);
  const GridRequest r{service, request, target, service.grids().find(path[3]), {path.begin() + 4, path.end()}};
  const Answer* answer = answer_at(target);
  if (answer == nullptr) throw no_such_address(request);
  return answer->make(r);
}

Cost cost_of_api(const Target& target) {
  const Answer* answer = target.path.size() > 4 ? answer_at(target) : nullptr;
  if (answer == nullptr) return Cost::kCheap;
  return answer->cost_of ? answer->cost_of(target) : answer->cost;
}

Response answered(Service& service, const std::function<Response()>& answer) {
  try {
    try {
      return answer();
    } catch (const Replaced&) {  // a file that was replaced while it was closed is looked at now, instead of within half a second
      service.grids().recheck();
      return answer();
    }
  } catch (const Unwanted&) {
    throw;  // there is nobody to answer
  } catch (const Replaced& e) {
    return try_again("replaced", e.what());
  } catch (const HttpError& e) {
    if (e.status == 500) service.unreadable();
    return error_response(e.status, e.code, e.what());
  } catch (const UsageError& e) {
    return error_response(400, "bad_request", e.what());
  } catch (const FormatError& e) {
    service.damaged(e.what());
    return error_response(500, "damaged", e.what());
  } catch (const IoError& e) {
    service.damaged(e.what());
    return error_response(500, "unreadable", e.what());
  } catch (const std::bad_alloc&) {
    return try_again("out_of_memory", "the server is out of memory: ask for less, or try again later");
  } catch (const std::exception& e) {
    return error_response(500, "failed", e.what());
  }
}

}  // namespace teracell::server
