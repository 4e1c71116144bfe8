// Parses the head of a request from bytes that come in pieces of any size. Beast checks the grammar and stores nothing; the fields
// that the server uses are copied to a Head. A body is skipped. No socket here.
#pragma once
#include <boost/beast/http/basic_parser.hpp>

#include "server/http/wire.hpp"

namespace teracell::server {

class HeadParser : private boost::beast::http::basic_parser<true> {
 public:
  static constexpr size_t kMaxHead = size_t{16} << 10, kMaxBody = size_t{8} << 10;
  enum Progress { kMore, kWhole, kRefused };

  // For one request. Overwrites `head`, which must outlive it.
  explicit HeadParser(Head& head);
  // Removes from the front of `bytes` what belongs to this request. After kMore the caller passes the rest again, with more bytes
  // after it.
  Progress put(std::string_view& bytes);
  bool begun() const { return used_ > 0; }
  // Whether the connection can be kept, and the client wants it. REQUIRES: put() returned kWhole
  bool keep_alive() const { return !left_body_ && basic_parser::keep_alive(); }
  // The response to send. REQUIRES: put() returned kRefused
  Response& refusal() { return refusal_; }

 private:
  using View = boost::beast::string_view;
  using Code = boost::system::error_code;
  Progress put_head(std::string_view& bytes);
  Progress refuse(int status, const char* code, const std::string& message);

  void on_request_impl(boost::beast::http::verb, View method, View target, int version, Code&) override;
  void on_field_impl(boost::beast::http::field name, View name_text, View value, Code&) override;
  void on_header_impl(Code&) override {}
  void on_body_init_impl(const boost::optional<uint64_t>&, Code&) override {}
  size_t on_body_impl(View body, Code&) override { return body.size(); }
  void on_chunk_header_impl(uint64_t, View, Code&) override {}
  size_t on_chunk_body_impl(uint64_t, View body, Code&) override { return body.size(); }
  void on_finish_impl(Code&) override {}
  void on_response_impl(int, View, int, Code&) override {}

  Head& head_;
  size_t used_ = 0;  // bytes of the head
  uint64_t body_ = 0;  // bytes of the body that are still to come
  bool skipped_line_ = false, got_target_ = false, left_body_ = false;
  Response refusal_;
};

}  // namespace teracell::server
