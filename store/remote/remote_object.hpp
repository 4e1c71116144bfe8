// An object behind an address, read by ranges. It is always the object that was opened: each answer is compared with the ETag of the
// first one (or, if that is not a strong one, with Last-Modified as well) and with the size, so what was replaced is an error.
//
// Every request may be sent again: after a failure that may pass, up to kAttempts times. Redirects are followed, and the place to which
// the first request was sent is asked directly by the next ones, until it fails.
#pragma once
#include <mutex>
#include <optional>

#include "store/base/file.hpp"
#include "store/remote/http_client.hpp"
#include "store/remote/url.hpp"

namespace teracell::inline store {

// Where an object is.
struct RemotePlace {
  Url url;
  std::string name;  // for messages
  Signing signing;
  bool allow_http = false;
  double timeout = 15;
};

// Throws UsageError for an address that is not to be asked: over HTTP without TLS to another machine, unless that is allowed.
void expect_allowed(const Url& url, bool allow_http);

// The answer to a request for a part: "bytes 0-99/1000".
struct ContentRange {
  uint64_t first, last, size;
};
std::optional<ContentRange> parse_content_range(const std::string& text);

// Threads may share it.
class RemoteObject : public ByteSource {
 public:
  // Asks for the end of the object, which tells its size, too. Throws IoError.
  explicit RemoteObject(RemotePlace place);

  uint64_t size() const override { return size_; }
  const std::string& name() const override { return place_.name; }
  void read(uint64_t offset, std::span<uint8_t> out) const override;
  void read_many(std::span<const ByteRead> reads) const override;
  bool is_far() const override { return whole_.empty(); }
  bool was_replaced() const override;

  // What came with the first answer: the bytes from tail_offset() to the end.
  uint64_t tail_offset() const { return size_ - tail_.size(); }
  const Bytes& tail() const { return tail_; }
  // Stands for these bytes, and for no others: what a cache on disk is kept under. Empty if the host gives no strong ETag.
  const std::string& version() const { return strong_etag_; }

  static constexpr uint64_t kTail = 1 << 15;
  static constexpr uint64_t kMostWhole = uint64_t{16} << 20;  // an object that is taken as a whole from a host without ranges
  static constexpr int kAttempts = 4;

 private:
  bool open(std::optional<uint64_t> first, size_t most_of_whole, uint64_t& told_size);
  void accept(Exchange& e, uint64_t first, uint64_t last) const;
  void expect_same(const Exchange& e) const;
  std::vector<std::string> conditions() const;
  Exchange request(std::string range, size_t bytes, std::vector<std::string> headers) const;
  void perform(std::span<Exchange> exchanges) const { perform(exchanges, current_url()); }
  void perform(std::span<Exchange> exchanges, const std::string& url, int attempts = kAttempts) const;
  void follow(Exchange& e, std::string& from) const;
  [[noreturn]] void fail(const Exchange& e) const;
  bool is_worth_another_try(const Exchange& e) const;
  std::string current_url() const;

  const RemotePlace place_;
  mutable HttpClient client_;
  uint64_t size_ = 0;
  std::string etag_, strong_etag_, last_modified_;
  Bytes tail_;
  Bytes whole_;  // of a host without ranges
  mutable std::mutex mutex_;
  mutable std::string redirected_;  // where the address led; empty: nowhere else
};

}  // namespace teracell::store
