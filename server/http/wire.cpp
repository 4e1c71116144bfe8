#include "server/http/wire.hpp"

#include <algorithm>
#include <charconv>
#include <ctime>

#include <fmt/format.h>

#include "server/http/host.hpp"
#include "store/text/words.hpp"

namespace teracell::server {
namespace {

bool is_alnum(char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }

bool consists_of(std::string_view text, std::string_view others) {
  return std::ranges::all_of(text, [&](char c) { return is_alnum(c) || others.find(c) != others.npos; });
}

bool fits_link(std::string_view host) { return is_authority(host) && consists_of(host, ".:[]_-"); }

// The first value of a list: each proxy on the way appends its own.
std::string_view first_of(std::string_view list) { return trimmed(list.substr(0, list.find(','))); }

// Removes the next piece from the front of `rest`.
std::string_view next_piece(std::string_view& rest, char separator) {
  const size_t end = std::min(rest.find(separator), rest.size());
  const std::string_view piece = rest.substr(0, end);
  rest.remove_prefix(std::min(end + 1, rest.size()));
  return trimmed(piece);
}

// "q=0", "q=0.0", ...: not acceptable (RFC 9110, 12.4.2).
bool is_refused(std::string_view parameters) {
  while (!parameters.empty()) {
    const std::string_view p = next_piece(parameters, ';');
    if (p.size() > 2 && same_word(p.substr(0, 2), "q=")) return p.substr(2).find_first_not_of("0.") == p.npos;
  }
  return false;
}

std::string_view reason(int status) {
  switch (status) {
    case 200: return "OK";
    case 204: return "No Content";
    case 301: return "Moved Permanently";
    case 302: return "Found";
    case 303: return "See Other";
    case 304: return "Not Modified";
    case 307: return "Temporary Redirect";
    case 308: return "Permanent Redirect";
    case 400: return "Bad Request";
    case 401: return "Unauthorized";
    case 404: return "Not Found";
    case 405: return "Method Not Allowed";
    case 413: return "Content Too Large";
    case 414: return "URI Too Long";
    case 421: return "Misdirected Request";
    case 431: return "Request Header Fields Too Large";
    case 500: return "Internal Server Error";
    case 503: return "Service Unavailable";
    case 505: return "HTTP Version Not Supported";
    default: return "";
  }
}

void append_number(std::string& out, uint64_t n) {
  char text[20];
  out.append(text, std::to_chars(text, text + sizeof text, n).ptr);
}

// A value that comes from a request must not end its line.
void append_field(std::string& out, std::string_view name, std::string_view value) {
  out += name;
  const size_t at = out.size();
  out += value;
  std::replace_if(
      out.begin() + static_cast<std::ptrdiff_t>(at), out.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  out += "\r\n";
}

}  // namespace

void Head::clear() {
  for (std::string* s : {&method, &target, &host, &origin, &if_none_match, &accept_encoding, &authorization, &forwarded_for, &forwarded_proto,
                         &forwarded_host, &forwarded_prefix, &resource})
    s->clear();
  hosts = 0;
  http11 = true;
  https = expects_continue = has_transfer_encoding = false;
}

bool is_base_path(std::string_view text) {
  return text.empty() || (text.size() <= 1024 && text[0] == '/' && text.back() != '/' && text.find("//") == text.npos && consists_of(text, "/._~-"));
}

bool accepts_gzip(std::string_view list) {
  bool star = false;
  while (!list.empty()) {
    std::string_view parameters = next_piece(list, ',');
    const std::string_view coding = next_piece(parameters, ';');
    if (same_word(coding, "gzip") || same_word(coding, "x-gzip")) return !is_refused(parameters);
    if (coding == "*") star = !is_refused(parameters);
  }
  return star;
}

bool bears_token(std::string_view authorization, std::string_view token) {
  constexpr std::string_view scheme = "bearer ";
  const bool bearer = authorization.size() >= scheme.size() && same_word(authorization.substr(0, scheme.size()), scheme);
  const std::string_view found = bearer ? trimmed(authorization.substr(scheme.size())) : "";
  // The loop depends only on the length of what was sent, which the sender knows.
  unsigned char different = found.size() == token.size() && bearer ? 0 : 1;
  for (size_t i = 0; i < found.size(); ++i) different |= static_cast<unsigned char>(found[i] ^ token[i % token.size()]);
  return different == 0;
}

bool read_target(Head& head) {
  std::string_view target = head.target;
  if (head.method == "CONNECT" || (head.method == "OPTIONS" && target == "*")) return true;  // both are answered whatever they name
  if (!target.starts_with('/')) {
    const auto has = [&](std::string_view scheme) { return same_word(target.substr(0, scheme.size()), scheme); };
    head.https = has("https://");
    if (!head.https && !has("http://")) return false;
    target.remove_prefix(head.https ? 8 : 7);
    head.host.assign(target.substr(0, target.find_first_of("/?")));
    target.remove_prefix(head.host.size());
    if (!is_authority(head.host)) return false;
    if (!target.starts_with('/')) head.resource = '/';
  }
  head.resource += target;
  return true;
}

void fill_request(Request& out, const Head& head, std::string_view base_path, std::string_view local) {
  out.method = head.method;
  out.if_none_match = head.if_none_match;
  out.accepts_gzip = head.method != "HEAD" && accepts_gzip(head.accept_encoding);
  const std::string_view host = first_of(head.forwarded_host);
  const std::string_view scheme = first_of(head.forwarded_proto);
  out.origin.assign(same_word(scheme, "https") || (scheme.empty() && head.https) ? "https://" : "http://");
  out.origin.append(fits_link(host) ? host : fits_link(head.host) ? std::string_view(head.host) : local);
  std::string_view forwarded = first_of(head.forwarded_prefix);
  if (forwarded.ends_with('/')) forwarded.remove_suffix(1);
  out.prefix.assign(is_base_path(forwarded) ? forwarded : "");
  out.prefix.append(base_path);
  out.target = head.resource;
}

bool take_off_base(std::string& target, std::string_view base) {
  if (!target.starts_with(base)) return false;
  if (target.size() > base.size() && target[base.size()] != '/' && target[base.size()] != '?') return false;
  target.erase(0, base.size());
  return true;
}

void append_head(std::string& out, const Response& r, const Sending& sending) {
  out += "HTTP/1.1 ";
  append_number(out, static_cast<uint64_t>(r.status));
  out += ' ';
  out += reason(r.status);
  out += "\r\nServer: teracell\r\nDate: ";
  out += sending.date;
  out += "\r\nX-Content-Type-Options: nosniff\r\n";
  if (!sending.origin.empty()) append_field(out, "Access-Control-Expose-Headers: *\r\nAccess-Control-Allow-Origin: ", sending.origin);
  if (sending.origin != "*") out += "Vary: Origin\r\n";
  if (r.status != 204 && r.status != 304) {
    if (!r.content_type.empty()) append_field(out, "Content-Type: ", r.content_type);
    if (r.rest) {
      if (sending.http11) out += "Transfer-Encoding: chunked\r\n";
    } else {
      out += "Content-Length: ";
      append_number(out, r.body ? r.body->size() : 0);
      out += "\r\n";
    }
  }
  if (!r.etag.empty()) append_field(out, "ETag: ", r.etag);
  if (!r.cache_control.empty()) append_field(out, "Cache-Control: ", r.cache_control);
  if (!r.content_encoding.empty()) append_field(out, "Content-Encoding: ", r.content_encoding);
  if (!r.location.empty()) append_field(out, "Location: ", r.location);
  out += r.more_fields;
  if (!r.content_type.starts_with("image/") || r.content_type == "image/svg+xml")
    out += "Vary: Accept-Encoding\r\n";  // pixels are never compressed again
  switch (r.status) {
    case 204:
      out +=
          "Access-Control-Allow-Methods: GET, HEAD, OPTIONS\r\nAccess-Control-Allow-Headers: range, if-none-match, authorization\r\n"
          "Access-Control-Max-Age: 86400\r\nAllow: GET, HEAD, OPTIONS\r\n";
      break;
    case 401: out += "WWW-Authenticate: Bearer realm=\"teracell\"\r\n"; break;
    case 405: out += "Allow: GET, HEAD, OPTIONS\r\n"; break;
    default: break;
  }
  if (!sending.keep_alive) out += "Connection: close\r\n";
  else if (!sending.http11) out += "Connection: keep-alive\r\n";
  out += "\r\n";
}

// Not with strftime: the names must not depend on a locale.
std::string http_date(int64_t unix_seconds) {
  const std::time_t t = unix_seconds;
  std::tm m{};
  gmtime_r(&t, &m);
  constexpr const char* day[] = {"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr const char* month[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  return fmt::format("{}, {:02} {} {} {:02}:{:02}:{:02} GMT", day[m.tm_wday], m.tm_mday, month[m.tm_mon], m.tm_year + 1900, m.tm_hour, m.tm_min,
                     m.tm_sec);
}

}  // namespace teracell::server
