// What answers requests, as the listener sees it.
#pragma once
#include <functional>
#include <optional>
#include <string_view>

#include "server/service/message.hpp"

namespace teracell {

// Threads call these functions at once.
struct Handler {
  std::function<std::optional<Response>(const Request&)> at_once;  // an answer that needs no reading and no making; must be quick
  std::function<Response(const Request&)> handle;                  // any request
  std::function<bool(std::string_view path)> is_open = {};         // whether a path needs no token; not set: every path needs it
  std::function<bool(const Request&)> is_dear = {};              // whether the answer may take long; not set: no answer does
};

}  // namespace teracell
