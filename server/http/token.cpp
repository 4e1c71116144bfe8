#include "server/http/token.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <fstream>
#include <system_error>

#include <fmt/format.h>

#include "store/error.hpp"

namespace teracell {

std::string read_token(const std::filesystem::path& file) {
  constexpr size_t kLongest = 4096;
  std::ifstream in(file);
  std::string token;
  if (in) in.peek();  // a folder can be opened, but not read
  if (in.bad() || !in.is_open()) throw IoError(fmt::format("{}: can't be read: {}", file.string(), std::generic_category().message(errno)));
  std::getline(in, token);
  while (!token.empty() && std::isspace(static_cast<unsigned char>(token.back()))) token.pop_back();
  const auto is_bad = [](char c) { return c <= 0x20 || c >= 0x7f; };
  if (token.empty() || token.size() > kLongest || std::ranges::any_of(token, is_bad))
    throw UsageError(fmt::format("{}: expected a first line of 1 to {} printable ASCII characters without spaces, found {}", file.string(), kLongest,
                                 token.empty()             ? "an empty one"
                                 : token.size() > kLongest ? fmt::format("{} characters", token.size())
                                                           : "other characters"));
  return token;
}

}  // namespace teracell
