#include "server/http/token.hpp"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>

#include "store/base/file.hpp"

namespace teracell::server {

std::string read_token(const std::filesystem::path& file) {
  constexpr size_t kLongestToken = 4096, kMost = 65536;  // the second: with white space at its end
  const InputFile in(file);
  std::string token(std::min<uint64_t>(in.size(), kMost), '\0');
  in.read(0, {reinterpret_cast<uint8_t*>(token.data()), token.size()});
  token.resize(std::min(token.find('\n'), token.size()));
  while (!token.empty() && std::isspace(static_cast<unsigned char>(token.back()))) token.pop_back();
  const auto is_bad = [](char c) { return c <= 0x20 || c >= 0x7f; };
  if (token.empty() || token.size() > kLongestToken || std::ranges::any_of(token, is_bad))
    throw UsageError(fmt::format("{}: expected a first line of 1 to {} printable ASCII characters without spaces, found {}", file.string(),
                                 kLongestToken,
                                 token.empty()                  ? "an empty one"
                                 : token.size() > kLongestToken ? "a longer one"
                                                                : "other characters"));
  return token;
}

bool others_can_read(const std::filesystem::path& file) {
  using std::filesystem::perms;
  std::error_code ignored;
  const perms allowed = std::filesystem::status(file, ignored).permissions();
  return allowed != perms::unknown && (allowed & (perms::group_read | perms::others_read)) != perms::none;
}

}  // namespace teracell::server
