// What answers requests, as the listener sees it.
#pragma once
#include <functional>
#include <optional>
#include <string_view>

#include "server/http.hpp"

namespace teracell {

// Threads call both at once.
struct Handler {
  std::function<std::optional<Response>(const Request&)> at_once;  // when nothing must be read or made: it may not take long
  std::function<Response(const Request&)> handle;                  // any request
  std::function<bool(std::string_view path)> is_open = {};         // whether it is for anybody, without a token; none: nothing is
};

}  // namespace teracell
