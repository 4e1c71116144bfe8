#include "server/service/message.hpp"

#include <fmt/format.h>

#include "store/text/json_text.hpp"
#include "store/text/text.hpp"

namespace teracell::server {

// Not from a JSON object: even its destructor allocates, and there may be no memory left.
Response error_response(int status, const std::string& code, const std::string& message) {
  Response r;
  r.status = status;
  r.content_type = "application/json";
  r.cache_control = "no-store";
  r.body = body_of(fmt::format(R"({{"error":{{"code":"{}","message":{}}}}})", code, ascii_json(shortened(message))));
  return r;
}

HttpError bad_request(const std::string& message) { return {400, "bad_request", message}; }
HttpError not_found(const std::string& message) { return {404, "not_found", message}; }

Response try_again(const std::string& code, const std::string& message) {
  Response r = error_response(503, code, message);
  r.more_fields = "Retry-After: 1\r\n";
  return r;
}

bool has_etag(std::string_view list, std::string_view etag) {
  for (size_t at = list.find(etag); at != std::string_view::npos; at = list.find(etag, at + 1)) {
    const size_t end = at + etag.size();
    const char before = at == 0 ? ',' : list[at - 1], after = end == list.size() ? ',' : list[end];
    if ((before == ',' || before == ' ' || before == '/') && (after == ',' || after == ' ')) return true;
  }
  return list == "*";
}

}  // namespace teracell::server
