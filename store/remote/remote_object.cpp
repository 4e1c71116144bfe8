#include "store/remote/remote_object.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <random>
#include <thread>

#include <fmt/format.h>

#include "store/base/wanted.hpp"
#include "store/text/text.hpp"
#include "store/text/words.hpp"

namespace teracell::inline store {
namespace {

constexpr int kMostRedirects = 5;
constexpr double kFirstPause = 0.2, kLongestPause = 10;  // seconds

bool may_pass(const Exchange& e) {
  return e.status == 0 ? e.may_pass : e.status == 408 || e.status == 429 || e.status == 500 || (e.status >= 502 && e.status <= 504);
}

// How long to wait before the next attempt: twice as long each time, and different for all who wait for the same host.
double pause_before(int attempt, const Exchange& failed) {
  thread_local std::minstd_rand random{std::random_device{}()};
  const double own = kFirstPause * (1 << (attempt - 1)) * std::uniform_real_distribution<double>(0.5, 1)(random);
  double asked = 0;
  const std::string& text = failed.header("retry-after");
  if (!text.empty() && text.size() < 4) std::from_chars(text.data(), text.data() + text.size(), asked);
  return std::min(std::max(own, asked), kLongestPause);
}

void wait(double seconds) {
  using Clock = std::chrono::steady_clock;
  for (const auto until = Clock::now() + std::chrono::duration<double>(seconds); Clock::now() < until;) {
    Wanted::stop_if_not();
    std::this_thread::sleep_for(std::min<std::chrono::duration<double>>(until - Clock::now(), std::chrono::milliseconds(100)));
  }
}

// What an answer says in words, without its markup, in one short line.
std::string words_of(const Bytes& body) {
  std::string out;
  bool inside = false;
  for (const uint8_t b : body) {
    const char c = static_cast<char>(b);
    if (c == '<') inside = true;
    const bool space = inside || c == ' ' || c == '\n' || c == '\r' || c == '\t';
    if (c == '>') inside = false;
    if (!space) out += c;
    else if (!out.empty() && out.back() != ' ') out += ' ';
    if (out.size() > 800) break;
  }
  while (!out.empty() && out.back() == ' ') out.pop_back();
  out = printable(out);
  return out.size() <= 200 ? out : std::string(first_bytes(out, 200)) + " ...";
}

// What an answer to a request with a secret says: the code and the message of an error of S3. Other words may repeat the request; Amazon's
// repeat the key and the token.
std::string safe_words_of(const Bytes& body) {
  const std::string_view text(reinterpret_cast<const char*>(body.data()), body.size());
  Bytes words;
  for (const std::string_view name : {"Code>", "Message>"}) {
    const size_t begin = text.find(fmt::format("<{}", name)), end = text.find(fmt::format("</{}", name));
    if (begin < end && end != std::string_view::npos) words.insert(words.end(), text.begin() + begin, text.begin() + end), words.push_back(' ');
  }
  return words_of(words);
}

std::string said_range(const Exchange& e) {
  const std::string& said = e.header("content-range");
  return said.empty() ? "without a Content-Range" : fmt::format("with '{}' as its Content-Range", words_of({said.begin(), said.end()}));
}

bool read_number(std::string_view& text, uint64_t& number) {
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  text.remove_prefix(static_cast<size_t>(rest - text.data()));
  return error == std::errc();
}

bool skip(std::string_view& text, std::string_view what) {
  if (!text.starts_with(what)) return false;
  text.remove_prefix(what.size());
  return true;
}

void expect_plain(const Exchange& e, const std::string& name) {
  if (const std::string& coding = e.header("content-encoding"); !coding.empty() && coding != "identity")
    throw IoError(
        fmt::format("{}: expected the bytes as they are, the host sends them encoded as '{}'", name, words_of({coding.begin(), coding.end()})));
}

}  // namespace

void expect_allowed(const Url& url, bool allow_http) {
  if (url.scheme == "https" || (url.scheme == "http" && (allow_http || is_loopback(url.host)))) return;
  if (url.scheme != "http") throw UsageError(fmt::format("{}: expected an https:// address", url.shown()));
  throw UsageError(fmt::format("{}: expected an https:// address: http:// can be read and changed on its way", url.shown()), Remedy::kAllowHttp);
}

std::optional<ContentRange> parse_content_range(const std::string& text) {
  std::string_view left = text;
  ContentRange r{};
  if (!skip(left, "bytes ") || !read_number(left, r.first) || !skip(left, "-") || !read_number(left, r.last) || !skip(left, "/") ||
      !read_number(left, r.size) || !left.empty() || r.first > r.last || r.last >= r.size)
    return std::nullopt;
  return r;
}

RemoteObject::RemoteObject(RemotePlace place) : place_(std::move(place)), client_(place_.timeout) {
  expect_allowed(place_.url, place_.allow_http);
  // Some hosts know ranges, but none that are counted from the end. What they send instead, the whole object, tells its size before it comes.
  uint64_t told_size = 0;
  if (open(std::nullopt, kTail, told_size)) return;
  if (!open(told_size - std::min(told_size, kTail), kMostWhole, told_size))
    throw IoError(fmt::format("{}: the host ignores ranges: it sends the whole object, which has more than {} MB, instead of a part", name(),
                              kMostWhole >> 20));
  Bytes tail(whole_.empty() && tail_.empty() ? std::min(size_, kTail) : 0);
  read(size_ - tail.size(), tail);
  if (!tail.empty()) tail_ = std::move(tail);
}

// Asks for kTail bytes from `first` on, or for the last ones. Returns false if the host does not know such a range, or sends the whole object, and
// that has more bytes than are taken: then told_size is its size, if the host says so.
bool RemoteObject::open(std::optional<uint64_t> first, size_t most_of_whole, uint64_t& told_size) {
  const bool from_end = !first;
  const std::string range = from_end ? fmt::format("-{}", kTail) : fmt::format("{}-{}", *first, *first + kTail - 1);
  Exchange e = request(range, kTail, {});
  e.most_of_whole = most_of_whole;
  perform({&e, 1});
  if (from_end && (e.status == 416 || e.status == 400 || e.status == 405 || e.status == 501)) return false;
  if (e.status == 416 && *first == 0) throw IoError(fmt::format("{}: the object is empty", name()));
  if (e.status != 200 && e.status != 206) fail(e);
  expect_plain(e, name());
  etag_ = e.header("etag");
  strong_etag_ = etag_.starts_with("W/") ? "" : etag_;
  last_modified_ = e.header("last-modified");
  if (etag_.empty() && last_modified_.empty())
    throw IoError(fmt::format("{}: the host sends neither ETag nor Last-Modified, so it would not be noticed if the object were replaced", name()));
  if (e.status == 200) {
    if (e.cut) {
      told_size = number_in<uint64_t>(e.header("content-length")).value_or(0);
      return false;
    }
    whole_ = std::move(e.body);
    size_ = whole_.size();
    return true;
  }
  const auto found = parse_content_range(e.header("content-range"));
  const uint64_t begin = first ? *first : found ? found->size - std::min(found->size, kTail) : 0;
  if (!found || found->first != begin || found->last != std::min(found->size, begin + kTail) - 1) {
    if (from_end) return false;  // s3rver, for one, takes -100 for 0-100
    throw IoError(fmt::format("{}: asked for the range {}, the host answers {}", name(), range, said_range(e)));
  }
  size_ = found->size;
  if (e.cut || e.body.size() != found->last - begin + 1)
    throw IoError(fmt::format("{}: expected {} bytes from {} on, the host sent {}", name(), found->last - begin + 1, begin,
                              e.cut ? "more" : fmt::format("{}", e.body.size())));
  if (found->last + 1 == size_) tail_ = std::move(e.body);
  return true;
}

std::vector<std::string> RemoteObject::conditions() const {
  if (!strong_etag_.empty()) return {"If-Match: " + strong_etag_};
  if (!last_modified_.empty()) return {"If-Unmodified-Since: " + last_modified_};
  return {};
}

Exchange RemoteObject::request(std::string range, size_t bytes, std::vector<std::string> headers) const {
  Exchange e;
  e.range = std::move(range);
  e.headers = std::move(headers);
  e.most_of_part = bytes;
  return e;
}

void RemoteObject::read(uint64_t offset, std::span<uint8_t> out) const {
  const ByteRead one{offset, out};
  read_many({&one, 1});
}

void RemoteObject::read_many(std::span<const ByteRead> reads) const {
  std::vector<Exchange> exchanges;
  for (const ByteRead& r : reads) {
    if (r.offset > size_ || r.out.size() > size_ - r.offset)
      throw IoError(fmt::format("{}: byte {}: expected {} more bytes, found the end of the object", name(), r.offset, r.out.size()));
    if (!whole_.empty()) std::copy_n(whole_.data() + r.offset, r.out.size(), r.out.data());
    else if (!r.out.empty()) exchanges.push_back(request(fmt::format("{}-{}", r.offset, r.offset + r.out.size() - 1), r.out.size(), conditions()));
  }
  perform(exchanges);
  auto e = exchanges.begin();
  for (const ByteRead& r : reads) {
    if (!whole_.empty() || r.out.empty()) continue;
    accept(*e, r.offset, r.offset + r.out.size() - 1);
    std::ranges::copy(e->body, r.out.data());
    ++e;
  }
}

void RemoteObject::expect_same(const Exchange& e) const {
  const std::string& etag = e.header("etag");
  const std::string& modified = e.header("last-modified");
  const bool same = etag == etag_ && (!strong_etag_.empty() || modified == last_modified_);
  if (!same) throw Replaced(fmt::format("{}: the object changed while it was read: open it again", name()));
}

// Throws unless the answer has these bytes of this object.
void RemoteObject::accept(Exchange& e, uint64_t first, uint64_t last) const {
  const auto changed = [&] { throw Replaced(fmt::format("{}: the object changed while it was read: open it again", name())); };
  if (e.status == 412) changed();
  if (e.status == 416 && e.header("content-range") != fmt::format("bytes */{}", size_)) changed();
  if (e.status == 200) {
    expect_same(e);
    throw IoError(fmt::format("{}: the host ignores ranges: it sends the whole object instead of {} bytes", name(), last - first + 1));
  }
  if (e.status != 206) fail(e);
  expect_same(e);
  const auto found = parse_content_range(e.header("content-range"));
  if (found && found->size != size_) changed();
  if (!found || found->first != first || found->last != last)
    throw IoError(fmt::format("{}: asked for bytes {} to {}, the host answers {}", name(), first, last, said_range(e)));
  expect_plain(e, name());
  if (e.cut || e.body.size() != last - first + 1)
    throw IoError(fmt::format("{}: byte {}: expected {} bytes, the host sent {}", name(), first, last - first + 1,
                              e.cut ? "more" : fmt::format("{}", e.body.size())));
}

bool RemoteObject::was_replaced() const {
  std::vector<std::string> headers;
  if (!etag_.empty()) headers = {"If-None-Match: " + etag_};
  else headers = {"If-Modified-Since: " + last_modified_};
  Exchange e = request("0-0", 1, headers);
  perform({&e, 1}, place_.url.text, 1);  // the address may lead elsewhere by now; who asks will ask again
  if (e.status == 304) return false;
  if (e.status == 416 || e.status == 404 || e.status == 410) return true;
  if (e.status != 200 && e.status != 206) fail(e);
  const auto found = parse_content_range(e.header("content-range"));
  if (e.status == 206 && (!found || found->size != size_)) return true;
  return e.header("etag") != etag_ || (strong_etag_.empty() && e.header("last-modified") != last_modified_);
}

void RemoteObject::fail(const Exchange& e) const {
  if (e.status == 0)
    throw IoError(fmt::format("{}: {}{}", name(), words_of({e.failure.begin(), e.failure.end()}),
                              is_worth_another_try(e) ? fmt::format(" (tried {} times)", kAttempts) : ""));
  const bool secret = e.url.find('?') != std::string::npos || (e.signing != nullptr && !e.signing->key_id.empty());
  const std::string words = secret ? safe_words_of(e.body) : words_of(e.body);
  const bool unsigned_s3 = e.status == 403 && place_.name.starts_with("s3://") && place_.signing.key_id.empty();
  const int number = e.status == 404 || e.status == 410 ? ENOENT : e.status == 401 || e.status == 403 ? EACCES : 0;
  throw IoError(fmt::format("{}: the host answers with status {}{}{}", name(), e.status, words.empty() ? "" : ": " + words,
                            unsigned_s3 ? " (the request was not signed: AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY are not set)" : ""),
                number);
}

// While the object is being opened, an address at which nobody listens is taken for a mistake.
bool RemoteObject::is_worth_another_try(const Exchange& e) const { return may_pass(e) && !(e.refused && size_ == 0); }

std::string RemoteObject::current_url() const {
  std::lock_guard lock(mutex_);
  return redirected_.empty() ? place_.url.text : redirected_;
}

// Sends the exchange to where the host says. `from` is where it was sent.
void RemoteObject::follow(Exchange& e, std::string& from) const {
  try {
    const Url next = parse_url(e.redirect(), from);
    if (parse_url(from).scheme == "https" && next.scheme != "https")
      throw UsageError(fmt::format("{}: expected to stay at an https:// address", next.shown()));
    expect_allowed(next, place_.allow_http);
    from = next.text;
  } catch (const UsageError& refused) {
    throw IoError(fmt::format("{}: the host sends us elsewhere: {}", name(), refused.what()), refused.remedy);
  }
}

// Does the exchanges, with redirects, and again what may pass. What is left of failures is in them.
void RemoteObject::perform(std::span<Exchange> exchanges, const std::string& url, int attempts) const {
  struct State {
    std::string url;
    int redirects = 0, attempts = 0;
    bool remembered = false;  // the URL is where an earlier redirect led
  };
  std::vector<State> states(exchanges.size());
  std::vector<size_t> left;
  for (size_t i = 0; i < exchanges.size(); ++i) {
    states[i].url = url;
    states[i].remembered = states[i].url != place_.url.text;
    left.push_back(i);
  }
  while (!left.empty()) {
    std::vector<Exchange> round;
    for (const size_t i : left) {
      Exchange e = request(exchanges[i].range, exchanges[i].most_of_part, exchanges[i].headers);
      e.most_of_whole = exchanges[i].most_of_whole;
      const Url to = parse_url(states[i].url);
      e.url = to.text;
      e.loopback = is_loopback(to.host);
      e.signing = to.origin() == place_.url.origin() ? &place_.signing : nullptr;  // others must not learn what our key signs
      round.push_back(std::move(e));
    }
    client_.perform(round);
    std::vector<size_t> again;
    double pause = 0;
    for (size_t n = 0; n < left.size(); ++n) {
      const size_t i = left[n];
      Exchange& e = exchanges[i] = std::move(round[n]);
      State& s = states[i];
      if (!e.redirect().empty()) {
        if (++s.redirects > kMostRedirects) throw IoError(fmt::format("{}: the host redirects more than {} times", name(), kMostRedirects));
        follow(e, s.url);
        again.push_back(i);
      } else if (s.remembered && (e.status == 0 || (e.status >= 400 && e.status != 412 && e.status != 416))) {
        s = {place_.url.text, 0, s.attempts, false};  // such places expire, or are one of several that come and go
        again.push_back(i);
      } else if (is_worth_another_try(e) && ++s.attempts < attempts) {
        pause = std::max(pause, pause_before(s.attempts, e));
        again.push_back(i);
      } else if (!s.remembered && (e.status == 200 || e.status == 206)) {
        std::lock_guard lock(mutex_);
        redirected_ = s.redirects > 0 ? s.url : "";
      }
    }
    left = std::move(again);
    if (pause > 0) wait(pause);
  }
  for (Exchange& e : exchanges)
    if (e.status == 0) fail(e);
}

}  // namespace teracell::store
