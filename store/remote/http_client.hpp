// Requests over HTTP, several at a time, by libcurl. Connections are kept and used again, by all clients of the program: there are as many
// as threads need, however many objects are read. Threads may share a client.
#pragma once
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "store/remote/sources.hpp"

namespace teracell::inline store {

// How requests are signed: by AWS's signature, version 4. Without a key they are not.
struct Signing {
  std::string key_id, secret, session_token, region;
};

// One request and its answer.
struct Exchange {
  // The request: a GET.
  std::string url;
  std::string range;                 // "0-99", "-100"
  std::vector<std::string> headers;  // "If-Match: ..."
  const Signing* signing = nullptr;
  bool loopback = false;  // never by way of a proxy
  // The most bytes of a body that are taken, by status: more are cut off.
  size_t most_of_part = 0;   // 206
  size_t most_of_whole = 0;  // 200
  // The answer. The names of its headers are in lower case.
  int status = 0;  // 0: there is none; `failure` says why
  std::map<std::string, std::string> answer_headers;
  Bytes body;
  bool cut = false;         // the body is longer than was taken
  std::string failure;      // why there is no whole answer
  bool may_pass = false;    // the failure may pass: a connection that broke, or a stall
  bool refused = false;     // nobody listens there

  const std::string& header(const std::string& name) const;
  // Where the host sends us, perhaps relative to `url`; empty: nowhere.
  const std::string& redirect() const;
};

class HttpClient {
 public:
  // `timeout`: seconds until a connection stands, and without progress.
  explicit HttpClient(double timeout);
  ~HttpClient();
  HttpClient(const HttpClient&) = delete;
  // Does all of them, at most kAtOnce at a time, each once. Failures are in the exchanges. Throws what Wanted throws.
  void perform(std::span<Exchange> exchanges);
  static constexpr size_t kAtOnce = kMostFetches;

 private:
  class Session;  // what one thread uses at a time, with its connections
  struct Idle;
  static std::shared_ptr<Idle> shared_idle();
  const double timeout_;
  const std::shared_ptr<Idle> idle_;
};

}  // namespace teracell::store
