#include "store/remote/url.hpp"

#include <cctype>
#include <memory>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/remote/libcurl.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

// For messages about what is not an address: without a query, and without what may be a name and a password.
std::string without_secrets(const std::string& address) {
  std::string text = address.substr(0, address.find_first_of("?#"));
  if (const size_t at = text.rfind('@'); at != std::string::npos) {
    const size_t scheme = text.find("://"), begin = scheme < at ? scheme + 3 : 0;
    text.replace(begin, at - begin, "...");
  }
  return printable(first_bytes(text, 256));
}

}  // namespace

std::string Url::shown() const { return printable(first_bytes(text.substr(0, text.find('?')), 512)); }

Url parse_url(const std::string& address, const std::string& base) {
  const LibCurl& curl = libcurl();
  const std::unique_ptr<CURLU, void (*)(CURLU*)> parsed(curl.url(), curl.url_cleanup);
  const std::string whole = address.substr(0, address.find('#'));
  const auto set = [&](const std::string& given) {
    std::string text;  // libcurl takes no blanks from 8.14 on
    for (const char c : given) text += c == ' ' ? "%20" : std::string(1, c);
    return curl.url_set(parsed.get(), CURLUPART_URL, text.c_str(), CURLU_URLENCODE | CURLU_PATH_AS_IS);
  };
  if (!base.empty()) set(base);
  if (const CURLUcode code = set(whole); code != CURLUE_OK)
    throw UsageError(fmt::format("{}: not an address: {}", without_secrets(address), curl.url_strerror(code)));
  const auto part = [&](CURLUPart which, unsigned flags = 0) {
    char* found = nullptr;
    if (curl.url_get(parsed.get(), which, &found, flags) != CURLUE_OK || found == nullptr) return std::string();
    std::string text = found;
    curl.free(found);
    return text;
  };
  if (!part(CURLUPART_USER).empty() || !part(CURLUPART_PASSWORD).empty())
    throw UsageError("expected an address without a name and a password in it, found one with them: programs show addresses, and log them");
  return {part(CURLUPART_SCHEME), part(CURLUPART_HOST),  part(CURLUPART_PORT, CURLU_DEFAULT_PORT),
          part(CURLUPART_PATH),   part(CURLUPART_QUERY), part(CURLUPART_URL)};
}

bool is_loopback(const std::string& host) {
  if (host == "localhost" || host == "[::1]") return true;
  if (!host.starts_with("127.")) return false;
  int dots = 0;  // a name like 127.example.org is not one
  for (const char c : host) {
    if (c == '.') ++dots;
    else if (!std::isdigit(static_cast<unsigned char>(c))) return false;
  }
  return dots == 3;
}

std::string encoded_path(std::string_view path) {
  std::string out;
  for (const char c : path) {
    if (std::isalnum(static_cast<unsigned char>(c)) || std::string_view("-._~/").find(c) != std::string_view::npos) out += c;
    else out += fmt::format("%{:02X}", static_cast<unsigned char>(c));
  }
  return out;
}

}  // namespace teracell::store
