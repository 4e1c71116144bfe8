#include "store/remote/http_client.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>

#include <unistd.h>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/wanted.hpp"
#include "store/remote/libcurl.hpp"
#include "store/text/words.hpp"

namespace teracell::inline store {
namespace {

constexpr size_t kMostOfError = 4096;  // bytes of the body of an answer that is neither 200 nor 206
constexpr size_t kMostOfHeaders = 65536;
constexpr char kHashOfNothing[] = "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855";  // SHA-256 of the body of a GET
constexpr long kSlow = 1000;  // bytes per second: what is slower for so many seconds has stalled

// Whether the path has "." or ".." between slashes, which libcurl would resolve.
bool has_dots(std::string_view url) {
  const auto has = [&](std::string_view part) { return url.find(part) != url.npos; };
  return has("/./") || has("/../") || url.ends_with("/.") || url.ends_with("/..");
}

bool is_passing(CURLcode code) {
  switch (code) {
    case CURLE_COULDNT_CONNECT:
    case CURLE_OPERATION_TIMEDOUT:
    case CURLE_GOT_NOTHING:
    case CURLE_SEND_ERROR:
    case CURLE_RECV_ERROR:
    case CURLE_PARTIAL_FILE:
    case CURLE_SSL_CONNECT_ERROR: return true;
    default: return false;
  }
}

// An exchange while libcurl has it.
struct Transfer {
  Exchange* exchange = nullptr;
  CURL* handle = nullptr;
  curl_slist* headers = nullptr;
  size_t header_bytes = 0;
  char error[CURL_ERROR_SIZE] = "";

  size_t limit() const { return exchange->status == 206 ? exchange->most_of_part : exchange->status == 200 ? exchange->most_of_whole : kMostOfError; }
};

size_t on_header(const char* data, size_t, size_t size, void* at) try {
  auto& t = *static_cast<Transfer*>(at);
  const std::string_view line(data, size);
  t.header_bytes += size;
  if (t.header_bytes > kMostOfHeaders) return 0;
  if (line.starts_with("HTTP/")) {  // of the last answer, if there are others like 100 before it
    t.exchange->answer_headers.clear();
    t.exchange->body.clear();
    const size_t space = line.find(' ');
    t.exchange->status = space == std::string_view::npos ? 0 : std::atoi(std::string(line.substr(space + 1, 3)).c_str());
    return size;
  }
  const size_t colon = line.find(':');
  if (colon == std::string_view::npos) return size;
  std::string name(line.substr(0, colon));
  std::ranges::transform(name, name.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  t.exchange->answer_headers[name] = trimmed(line.substr(colon + 1));
  return size;
} catch (const std::exception&) {
  return 0;
}

size_t on_body(const char* data, size_t, size_t size, void* at) try {
  auto& t = *static_cast<Transfer*>(at);
  Bytes& body = t.exchange->body;
  const size_t limit = t.limit();
  if (body.empty() && t.exchange->status == 200) {  // does not wait for the limit when the host tells the length
    const std::string& length = t.exchange->header("content-length");
    if (length.size() > 18 || std::strtoull(length.c_str(), nullptr, 10) > limit) t.exchange->cut = true;
  }
  const size_t taken = t.exchange->cut ? 0 : std::min(size, limit - body.size());
  body.insert(body.end(), data, data + taken);
  if (taken < size) t.exchange->cut = true;
  return taken;
} catch (const std::exception&) {
  return 0;
}

}  // namespace

const std::string& Exchange::header(const std::string& name) const {
  static const std::string kNone;
  const auto found = answer_headers.find(name);
  return found == answer_headers.end() ? kNone : found->second;
}

const std::string& Exchange::redirect() const {
  const bool leads_on = status == 301 || status == 302 || status == 303 || status == 307 || status == 308;
  return header(leads_on ? "location" : "");
}

class HttpClient::Session {
 public:
  Session() : curl_(libcurl()), process_(::getpid()), multi_(curl_.multi_init()) {
    if (multi_ == nullptr) throw IoError("libcurl can't make a set of transfers");
    curl_.multi_setopt(multi_, CURLMOPT_MAXCONNECTS, static_cast<long>(kAtOnce));
  }
  ~Session() {
    for (Transfer& t : transfers_) {
      if (t.exchange != nullptr) curl_.multi_remove_handle(multi_, t.handle);
      curl_.easy_cleanup(t.handle);
      curl_.slist_free_all(t.headers);
    }
    curl_.multi_cleanup(multi_);
  }
  Session(const Session&) = delete;
  // After a fork, the connections are those of the parent, too.
  bool is_of_this_process() const { return process_ == ::getpid(); }

  void perform(std::span<Exchange> exchanges, const HttpClient& client) {
    size_t next = 0, running = 0;
    const auto begin_more = [&] {
      for (Transfer& t : transfers_)
        if (t.exchange == nullptr && next < exchanges.size()) begin(t, exchanges[next++], client.timeout_), ++running;
    };
    begin_more();
    while (running > 0) {
      Wanted::stop_if_not();
      int ignored;
      if (const CURLMcode code = curl_.multi_perform(multi_, &ignored); code != CURLM_OK) throw IoError(curl_.multi_strerror(code));
      bool ended = false;
      while (const CURLMsg* message = curl_.multi_info_read(multi_, &ignored))
        if (message->msg == CURLMSG_DONE) end(message->easy_handle, message->data.result), --running, ended = true;
      if (ended) begin_more();
      else curl_.multi_poll(multi_, nullptr, 0, 100, &ignored);  // so often it is asked whether this is still wanted
    }
  }

 private:
  void begin(Transfer& t, Exchange& e, double timeout) {
    if (t.handle == nullptr) t.handle = curl_.easy_init();
    if (t.handle == nullptr) throw IoError("libcurl can't make a transfer");
    curl_.easy_reset(t.handle);
    curl_.slist_free_all(t.headers);
    t.headers = nullptr;
    t.header_bytes = 0;
    t.error[0] = 0;
    const auto set = [&](CURLoption option, auto value) { curl_.easy_setopt(t.handle, option, value); };
    const auto add_header = [&](const std::string& line) { t.headers = curl_.slist_append(t.headers, line.c_str()); };
    for (const std::string& line : e.headers) add_header(line);
    set(CURLOPT_URL, e.url.c_str());
    set(CURLOPT_PROTOCOLS_STR, "http,https");
    set(CURLOPT_HTTP_VERSION, long{CURL_HTTP_VERSION_1_1});  // stores of objects speak nothing newer
    set(CURLOPT_USERAGENT, "teracell");
    set(CURLOPT_RANGE, e.range.c_str());
    set(CURLOPT_NOSIGNAL, 1L);
    set(CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(std::lround(timeout * 1000)));
    set(CURLOPT_LOW_SPEED_LIMIT, kSlow);
    set(CURLOPT_LOW_SPEED_TIME, static_cast<long>(std::max(1.0, std::ceil(timeout))));
    set(CURLOPT_ERRORBUFFER, t.error);
    set(CURLOPT_HEADERFUNCTION, &on_header);
    set(CURLOPT_HEADERDATA, static_cast<void*>(&t));
    set(CURLOPT_WRITEFUNCTION, &on_body);
    set(CURLOPT_WRITEDATA, static_cast<void*>(&t));
    for (const char* name : {"CURL_CA_BUNDLE", "SSL_CERT_FILE"})  // as the program curl takes them, for hosts with certificates of their own
      if (const char* file = std::getenv(name); file != nullptr && *file != 0) {
        set(CURLOPT_CAINFO, file);
        break;
      }
    if (e.loopback) set(CURLOPT_PROXY, "");
    const bool is_signed = e.signing != nullptr && !e.signing->key_id.empty();
    // Since 8.13 libcurl does not sign a path that it is to leave as it is. Only "." and ".." in it make a difference.
    if (!is_signed || has_dots(e.url)) set(CURLOPT_PATH_AS_IS, 1L);
    if (is_signed) {
      set(CURLOPT_AWS_SIGV4, fmt::format("aws:amz:{}:s3", e.signing->region).c_str());
      set(CURLOPT_USERNAME, e.signing->key_id.c_str());
      set(CURLOPT_PASSWORD, e.signing->secret.c_str());
      add_header(fmt::format("x-amz-content-sha256: {}", kHashOfNothing));  // stores want it, and libcurl 7.88 does not add it
      if (!e.signing->session_token.empty()) add_header("x-amz-security-token: " + e.signing->session_token);
    }
    set(CURLOPT_HTTPHEADER, t.headers);
    t.exchange = &e;
    if (const CURLMcode code = curl_.multi_add_handle(multi_, t.handle); code != CURLM_OK) {
      t.exchange = nullptr;
      throw IoError(curl_.multi_strerror(code));
    }
  }

  void end(CURL* handle, CURLcode result) {
    Transfer& t = *std::ranges::find(transfers_, handle, &Transfer::handle);
    Exchange& e = *t.exchange;
    curl_.multi_remove_handle(multi_, handle);
    t.exchange = nullptr;
    if (result == CURLE_OK || (result == CURLE_WRITE_ERROR && e.cut)) return;
    e.status = 0;
    e.failure = t.error[0] != 0 ? t.error : curl_.easy_strerror(result);
    if (e.failure.find('@') != std::string::npos) e.failure = curl_.easy_strerror(result);  // may be a proxy's address with a password
    // What libcurl calls memory is its own limit for one line.
    if (result == CURLE_OUT_OF_MEMORY || (result == CURLE_WRITE_ERROR && t.header_bytes > kMostOfHeaders))
      e.failure = fmt::format("the host's answer has headers of more than {} kB", kMostOfHeaders >> 10);
    e.may_pass = is_passing(result);
    e.refused = result == CURLE_COULDNT_CONNECT;
  }

  const LibCurl& curl_;
  const pid_t process_;
  CURLM* const multi_;
  std::array<Transfer, kAtOnce> transfers_;
};

struct HttpClient::Idle {
  std::mutex mutex;
  std::vector<std::unique_ptr<Session>> sessions;
};

// They last as long as there are clients.
std::shared_ptr<HttpClient::Idle> HttpClient::shared_idle() {
  static std::mutex mutex;
  static std::weak_ptr<Idle> shared;
  std::lock_guard lock(mutex);
  std::shared_ptr<Idle> idle = shared.lock();
  if (!idle) shared = idle = std::make_shared<Idle>();
  return idle;
}

HttpClient::HttpClient(double timeout) : timeout_(timeout), idle_(shared_idle()) {}
HttpClient::~HttpClient() = default;

void HttpClient::perform(std::span<Exchange> exchanges) {
  std::unique_ptr<Session> session;
  {
    std::lock_guard lock(idle_->mutex);
    while (!session && !idle_->sessions.empty()) {
      session = std::move(idle_->sessions.back());
      idle_->sessions.pop_back();
      // Not deleted: that would end the parent's connections.
      if (!session->is_of_this_process()) static_cast<void>(session.release());
    }
  }
  if (!session) session = std::make_unique<Session>();
  session->perform(exchanges, *this);  // a session in which something was thrown is not used again
  std::lock_guard lock(idle_->mutex);
  idle_->sessions.push_back(std::move(session));
}

}  // namespace teracell::store
