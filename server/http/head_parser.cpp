#include "server/http/head_parser.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/http/host.hpp"
#include "server/service/target.hpp"

namespace teracell::server {

namespace http = boost::beast::http;

HeadParser::HeadParser(Head& head) : head_(head) {
  head_.clear();
  header_limit(kMaxHead);
  body_limit(kMaxBody);
}

HeadParser::Progress HeadParser::put(std::string_view& bytes) {
  if (!is_header_done())
    if (const Progress p = put_head(bytes); p != kWhole) return p;
  const size_t skipped = std::min<uint64_t>(body_, bytes.size());
  bytes.remove_prefix(skipped);
  body_ -= skipped;
  return body_ > 0 ? kMore : kWhole;
}

HeadParser::Progress HeadParser::put_head(std::string_view& bytes) {
  if (!begun() && !skipped_line_ && bytes.starts_with('\r')) {  // an empty line in front is ignored (RFC 9112, 2.2)
    if (bytes.size() == 1) return kMore;
    skipped_line_ = bytes[1] == '\n';
    if (skipped_line_) bytes.remove_prefix(2);
  }
  if (bytes.empty()) return kMore;
  Code error;
  const size_t used = basic_parser::put({bytes.data(), bytes.size()}, error);
  bytes.remove_prefix(used);
  used_ += used;
  // Only excess of size and unknown versions get messages of their own.
  if (error == http::error::body_limit)
    return refuse(413, "too_large", fmt::format("expected a request without a body, found more than {} bytes", kMaxBody));
  if (error == http::error::bad_version) return refuse(505, "bad_version", "expected HTTP/1.0 or HTTP/1.1");
  if (error == http::error::header_limit || (error == http::error::need_more && used_ + bytes.size() >= kMaxHead)) {
    const std::string message = fmt::format("expected at most {} bytes of request line and header fields, found more", kMaxHead);
    return got_target_ ? refuse(431, "headers_too_large", message) : refuse(414, "target_too_long", message);
  }
  if (error == http::error::need_more) return kMore;
  if (error) return refuse(400, "bad_request", "malformed request: " + error.message());
  if (head_.has_transfer_encoding) return refuse(413, "too_large", "expected a request without a body, found Transfer-Encoding");
  if (head_.hosts > 1 || (head_.http11 && head_.hosts == 0))
    return refuse(400, "bad_request", fmt::format("expected one Host field, found {}", head_.hosts));
  if (head_.hosts == 1 && !is_authority(head_.host))
    return refuse(400, "bad_request", fmt::format("Host: expected a host, and perhaps a port, found {}", clipped(head_.host)));
  if (!read_target(head_))
    return refuse(400, "bad_request", fmt::format("expected an address like /path or http://host/path, found {}", clipped(head_.target)));
  body_ = content_length_remaining().value_or(0);
  // Nothing here needs a body. Rather than ask for one that the client holds back, the server answers and closes (RFC 9110, 10.1.1).
  left_body_ = head_.expects_continue && head_.http11 && body_ > 0;
  if (left_body_) body_ = 0;
  return kWhole;
}

HeadParser::Progress HeadParser::refuse(int status, const char* code, const std::string& message) {
  refusal_ = error_response(status, code, message);
  return kRefused;
}

void HeadParser::on_request_impl(http::verb, View method, View target, int version, Code&) {
  head_.method.assign(method.data(), method.size());
  head_.target.assign(target.data(), target.size());
  head_.http11 = version == 11;
  got_target_ = true;
}

void HeadParser::on_field_impl(http::field name, View name_text, View value, Code&) {
  const auto set = [value](std::string& out) { out.assign(value.data(), value.size()); };
  const auto add = [value](std::string& list) {
    if (!list.empty()) list += ", ";
    list.append(value.data(), value.size());
  };
  switch (name) {
    case http::field::host: ++head_.hosts; return set(head_.host);
    case http::field::origin: return set(head_.origin);
    case http::field::if_none_match: return add(head_.if_none_match);
    case http::field::accept_encoding: return add(head_.accept_encoding);
    case http::field::authorization: return set(head_.authorization);
    case http::field::expect: head_.expects_continue |= boost::beast::iequals(value, "100-continue"); return;
    case http::field::transfer_encoding: head_.has_transfer_encoding = true; return;
    default: break;
  }
  if (name_text.size() < 15 || (name_text[0] | 0x20) != 'x') return;
  if (boost::beast::iequals(name_text, "x-forwarded-for")) add(head_.forwarded_for);
  else if (boost::beast::iequals(name_text, "x-forwarded-proto")) set(head_.forwarded_proto);
  else if (boost::beast::iequals(name_text, "x-forwarded-host")) set(head_.forwarded_host);
  else if (boost::beast::iequals(name_text, "x-forwarded-prefix")) set(head_.forwarded_prefix);
}

}  // namespace teracell::server
