// A request and a response as values: no socket here. The listener makes the one and sends the other; routes map one to
// the other, tests do both by hand.
#pragma once
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "store/error.hpp"

namespace teracell {

struct Request {
  std::string method = "GET";  // "GET", "HEAD" or "OPTIONS": the listener refuses others
  std::string target = "/";    // as it was sent: percent-encoded, with its query
  std::string if_none_match;
  bool accepts_gzip = false;
  std::string origin;  // "http://host:8080", by the Host and X-Forwarded headers; no slash at the end
  std::string prefix;  // of X-Forwarded-Prefix, and the base path: what stands before every path of ours in links; no slash at the end
};

using Body = std::shared_ptr<const std::string>;  // cached bodies are shared, never copied

struct Response {
  int status = 200;
  std::string content_type;
  Body body;                  // of a HEAD request as well: the listener leaves it out and tells its length
  std::string etag;           // strong, with its quotes; empty: none
  std::string cache_control;  // empty: none
  std::string content_encoding;  // "gzip", or empty
  bool compressible = false;     // a client that accepts gzip gets another answer
  std::string location;          // of a redirect
  const char* more_fields = "";  // lines of the head with their ends; like the route, never anything out of the request
  const char* route = "other";    // for the metrics: one of a fixed few, never anything out of the request
};

inline Body body_of(std::string text) { return std::make_shared<const std::string>(std::move(text)); }

// A request that can't be answered: the message goes to the client as {"error": {"code", "message"}}.
struct HttpError : Error {
  HttpError(int s, std::string c, const std::string& message) : Error(message), status(s), code(std::move(c)) {}
  int status;
  std::string code;  // "bad_request", "not_found" ...
};
inline HttpError bad_request(const std::string& message) { return {400, "bad_request", message}; }
inline HttpError not_found(const std::string& message) { return {404, "not_found", message}; }

}  // namespace teracell
