// Between bytes and values: the fields of a request's head that matter to us, and the head of a response as it is sent.
// Pure; the listener brings the bytes.
#pragma once
#include <string>
#include <string_view>

#include "server/http.hpp"

namespace teracell {

// As it was sent. Reused from one request of a connection to the next: its strings keep their memory.
struct Head {
  std::string method, target, host, if_none_match, accept_encoding, authorization;
  std::string forwarded_proto, forwarded_host, forwarded_prefix;  // X-Forwarded-*
  int hosts = 0;           // how many Host fields
  bool http11 = true;
  bool has_transfer_encoding = false;
  void clear();
};

// What the head says, in our terms: the origin and the prefix of links (of the forwarded fields only what can stand in a
// link, the rest is ignored), and whether gzip is welcome (not for HEAD, whose Content-Length is the plain body's).
// `local` stands for a host that is not told. `out` is overwritten.
void fill_request(Request& out, const Head& head, std::string_view base_path, std::string_view local);

// Takes the base path off the front of a target. False, and nothing done, when the target lies outside of it.
bool take_off_base(std::string& target, std::string_view base_path);
std::string_view path_of(std::string_view target);  // without its query

// "", or "/" and segments of unreserved characters, none empty, no slash at the end: what may be a base path.
bool is_base_path(std::string_view text);
bool accepts_gzip(std::string_view accept_encoding);
// Whether an If-None-Match field names an ETag. It may list several, or be "*"; weak ones match too (RFC 9110, 13.1.2).
bool has_etag(std::string_view if_none_match, std::string_view etag);
// Whether an Authorization field carries the token. Takes the same time wherever they differ.
bool bears_token(std::string_view authorization, std::string_view token);

// {"error": {"code", "message"}}
Response error_response(int status, const std::string& code, const std::string& message);

struct Sending {
  bool keep_alive = true;
  bool http11 = true;
  std::string_view date;  // of RFC 9110
};
// Appends the status line and all fields, with the empty line at the end.
void append_head(std::string& out, const Response& response, const Sending& sending);
std::string http_date(int64_t unix_seconds);

}  // namespace teracell
