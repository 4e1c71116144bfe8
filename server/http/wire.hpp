// Between bytes and values: the fields of a request's head that the server uses, and the head of a response as it is sent.
// Pure: the listener brings the bytes.
#pragma once
#include <string>
#include <string_view>

#include "server/service/message.hpp"

namespace teracell::server {

// The head of a request as it was sent. A connection reuses it from one request to the next: its strings keep their memory.
struct Head {
  std::string method, target, host, origin, if_none_match, accept_encoding, authorization;
  std::string forwarded_for, forwarded_proto, forwarded_host, forwarded_prefix;  // X-Forwarded-*
  std::string resource;  // path and query, whatever the form of the target
  int hosts = 0;         // number of Host fields
  bool http11 = true;
  bool https = false;             // the target says so
  bool expects_continue = false;  // the client sends a body only when it is asked for it
  bool has_transfer_encoding = false;
  void clear();
};

// Reads the target by its form (RFC 9112, 3.2) and sets `resource`. The host of an absolute form takes the place of the Host field.
// Returns false for a target in no form that belongs to the method.
bool read_target(Head& head);

// Overwrites `out` with what the head means: the target, the origin and the prefix of links, and whether the client accepts
// gzip (never for HEAD, whose Content-Length is that of the plain body). Of hosts and forwarded fields only values that can stand in
// a link are used. `local` is the host when the head has no such one. REQUIRES: read_target() returned true
void fill_request(Request& out, const Head& head, std::string_view base_path, std::string_view local);

// Removes the base path from the front of a target. Returns false and changes nothing when the target lies outside of it.
bool take_off_base(std::string& target, std::string_view base_path);

// What may be a base path: "", or "/" and segments of unreserved characters, none of them empty, with no slash at the end.
bool is_base_path(std::string_view text);
bool accepts_gzip(std::string_view accept_encoding);
// Whether an Authorization field carries the token. Takes the same time wherever the two differ.
bool bears_token(std::string_view authorization, std::string_view token);

struct Sending {
  bool keep_alive = true;
  bool http11 = true;
  std::string_view date;          // as http_date() writes it
  std::string_view origin = "*";  // as allowed_origin() gives it
};
// Appends the status line and all fields, with the empty line at the end. A body with a rest is sent in chunks, or to a client of
// HTTP/1.0 until the connection is closed. REQUIRES: then keep_alive is not set for HTTP/1.0
void append_head(std::string& out, const Response& response, const Sending& sending);
std::string http_date(int64_t unix_seconds);

}  // namespace teracell::server
