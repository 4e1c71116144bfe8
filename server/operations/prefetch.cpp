#include "server/operations/prefetch.hpp"

#include <cstring>

#include "server/service/target.hpp"
#include "store/base/wanted.hpp"

namespace teracell::server {

std::vector<std::string> neighbours(const std::string& target) {
  if (target.compare(0, 14, "/api/v1/grids/") != 0) return {};
  const size_t slash = target.find('/', 14);
  if (slash == std::string::npos || target.compare(slash, 6, "/tile/") != 0) return {};
  const size_t begin = slash + 8, end = target.find('/', begin);  // "/tile/x/": one letter
  if (end == std::string::npos) return {};
  const auto index = plain_integer(std::string_view(target).substr(begin, end - begin));
  if (!index) return {};
  std::vector<std::string> out = {target.substr(0, begin) + std::to_string(*index + 1) + target.substr(end)};
  if (*index > 0) out.push_back(target.substr(0, begin) + std::to_string(*index - 1) + target.substr(end));
  return out;
}

Prefetch::Prefetch(std::function<void(const Request&)> fetch) : fetch_(std::move(fetch)), thread_([this] { work(); }) {}

Prefetch::~Prefetch() {
  {
    std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void Prefetch::begin() {
  std::lock_guard lock(mutex_);
  ++under_way_;
}

void Prefetch::end() {
  {
    std::lock_guard lock(mutex_);
    if (--under_way_ > 0 || waiting_.empty()) return;
  }
  changed_.notify_all();
}

void Prefetch::answered(const Request& request, const Response& response) {
  if ((response.status != 200 && response.status != 304) || std::strncmp(response.route, "tile", 4) != 0) return;
  {
    std::lock_guard lock(mutex_);
    if (request.target == last_) return;
    last_ = request.target;
    for (std::string& next : neighbours(last_)) waiting_.push_back({.target = std::move(next), .accepts_gzip = request.accepts_gzip});
    while (waiting_.size() > kMostWaiting) waiting_.pop_front();
    if (under_way_ > 0) return;
  }
  changed_.notify_all();
}

void Prefetch::work() {
  const Wanted wanted([this] {
    std::lock_guard lock(mutex_);
    if (closed_) throw Unwanted("the server stops");
  });
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return closed_ || (under_way_ == 0 && !waiting_.empty()); });
    if (closed_) return;
    const Request request = std::move(waiting_.back());  // the most recent first
    waiting_.pop_back();
    lock.unlock();
    try {
      fetch_(request);
    } catch (...) {  // a client that asks for it will get the error
    }
    lock.lock();
  }
}

Handler with_prefetch(Handler inner, Prefetch& prefetch) {
  return {[&prefetch, at_once = std::move(inner.at_once)](const Request& request) {
            std::optional<Response> r = at_once(request);
            if (r) prefetch.answered(request, *r);
            return r;
          },
          [&prefetch, handle = std::move(inner.handle)](const Request& request) {
            struct UnderWay {
              Prefetch& prefetch;
              explicit UnderWay(Prefetch& p) : prefetch(p) { prefetch.begin(); }
              ~UnderWay() { prefetch.end(); }
            };
            Response r = [&] {
              const UnderWay under_way(prefetch);
              return handle(request);
            }();
            prefetch.answered(request, r);
            return r;
          },
          std::move(inner.is_open), std::move(inner.cost_of)};
}

}  // namespace teracell::server
