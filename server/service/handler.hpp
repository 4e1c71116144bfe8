// What answers requests, as the listener sees it.
#pragma once
#include <functional>
#include <optional>
#include <string_view>

#include "server/service/message.hpp"

namespace teracell::server {

// How long an answer may take: a tile or a cell takes milliseconds; what the dashboard sees in three dimensions or along a line, a good part of
// a second; what may read much of a grid, or a large picture, as long as a request may work.
enum class Cost { kCheap, kSeen, kDear };

// Threads call these functions at once.
struct Handler {
  std::function<std::optional<Response>(const Request&)> at_once;  // an answer that needs no reading and no making; must be quick
  std::function<Response(const Request&)> handle;                  // any request
  std::function<bool(std::string_view path)> is_open = {};         // whether a path needs no token; not set: every path needs it
  std::function<Cost(const Request&)> cost_of = {};                // of the answer; not set: all are cheap
};

}  // namespace teracell::server
