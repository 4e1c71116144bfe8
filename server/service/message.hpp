// HTTP messages as values: a request, a response, and an error that becomes one. Nothing here knows a socket. The listener makes
// requests from bytes and sends responses; routes map one to the other; tests make both by hand.
#pragma once
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "store/base/error.hpp"

namespace teracell::server {

struct Request {
  std::string method = "GET";  // "GET", "HEAD" or "OPTIONS": the listener refuses others
  std::string target = "/";    // as it was sent: percent-encoded, with its query
  std::string if_none_match;
  bool accepts_gzip = false;
  std::string origin;  // "http://host:8080", from the Host and X-Forwarded fields; no slash at the end
  std::string prefix;  // X-Forwarded-Prefix and the base path: links begin with it; no slash at the end
};

using Body = std::shared_ptr<const std::string>;  // cached bodies are shared, never copied

// The body of a large answer, made part by part as the client takes it. For one thread at a time.
class Parts {
 public:
  static constexpr size_t kEnough = size_t{64} << 10;  // bytes of a part that need no more to be added
  virtual ~Parts() = default;
  // Appends the next part. Returns whether another one follows. What it throws ends the answer.
  virtual bool append(std::string& out) = 0;
  virtual size_t memory() const = 0;  // bytes that it keeps between two parts, about
};

struct Response {
  int status = 200;
  std::string content_type;
  Body body;                     // also for HEAD: the listener sends its length alone
  std::shared_ptr<Parts> rest;   // what follows the body; such a response is for one request and is not cached
  std::string etag;              // strong, with its quotes; empty: none
  std::string cache_control;     // empty: none
  std::string content_encoding;  // "gzip", or empty
  bool compressible = false;     // a client that accepts gzip gets a different response
  std::string location;          // of a redirect
  const char* more_fields = "";  // further lines of the head, each with its line end; never from the request
  const char* route = "other";   // for the metrics: one of a fixed few names, never from the request
};

inline Body body_of(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

// {"error": {"code", "message"}}
Response error_response(int status, const std::string& code, const std::string& message);

// The same with status 503, for what the same request may get in a second.
Response try_again(const std::string& code, const std::string& message);

// Whether an If-None-Match field names an ETag. The field may list several, or be "*"; weak ones match too (RFC 9110, 13.1.2).
bool has_etag(std::string_view if_none_match, std::string_view etag);

// A request that can't be answered: the client gets error_response().
struct HttpError : Error {
  HttpError(int s, std::string c, const std::string& message) : Error(message), status(s), code(std::move(c)) {}
  int status;
  std::string code;  // "bad_request", "not_found" ...
};
HttpError bad_request(const std::string& message);  // status 400
HttpError not_found(const std::string& message);    // status 404

}  // namespace teracell::server
