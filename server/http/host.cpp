#include "server/http/host.hpp"

#include <arpa/inet.h>

#include <algorithm>
#include <optional>

#include "store/text/words.hpp"

namespace teracell::server {
namespace {

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; }
bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_hex(char c) { return is_digit(c) || (lower(c) >= 'a' && lower(c) <= 'f'); }
bool is_letter_or_digit(char c) { return is_digit(c) || (lower(c) >= 'a' && lower(c) <= 'z'); }

// Zones and future versions of addresses, which the grammar knows, occur in no address of the web.
std::optional<in6_addr> ipv6(std::string_view host) {
  if (host.size() < 4 || host.size() > INET6_ADDRSTRLEN + 1 || host.front() != '[' || host.back() != ']') return std::nullopt;
  const std::string text(host.substr(1, host.size() - 2));
  in6_addr out;
  return text.find('\0') == text.npos && inet_pton(AF_INET6, text.c_str(), &out) == 1 ? std::optional(out) : std::nullopt;
}

// Four numbers. Other ways to write an IPv4 address never come from a browser.
bool is_ipv4(std::string_view text) {
  in_addr ignored;
  return text.size() < INET_ADDRSTRLEN && inet_pton(AF_INET, std::string(text).c_str(), &ignored) == 1;
}

// The grammar's reg-name, which includes IPv4 addresses. The length is that of the longest name in DNS.
bool is_registered_name(std::string_view text) {
  if (text.empty() || text.size() > 255) return false;
  for (size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '%') {
      if (i + 2 >= text.size() || !is_hex(text[i + 1]) || !is_hex(text[i + 2])) return false;
      i += 2;
    } else if (!is_letter_or_digit(text[i]) && std::string_view("-._~!$&'()*+,;=").find(text[i]) == std::string_view::npos) {
      return false;
    }
  }
  return true;
}

// The host of an authority. None when it is not one.
std::optional<std::string_view> host_of(std::string_view authority) {
  const size_t bracket = authority.rfind(']');
  const size_t colon = authority.find(':', bracket == authority.npos ? 0 : bracket);
  const std::string_view host = authority.substr(0, colon), port = colon == authority.npos ? "" : authority.substr(colon + 1);
  const bool good_port = port.empty() || number_in<uint16_t>(port);
  return good_port && (is_registered_name(host) || ipv6(host)) ? std::optional(host) : std::nullopt;
}

// A dot at the end says that the name is complete.
std::string_view without_dot(std::string_view host) { return host.ends_with('.') ? host.substr(0, host.size() - 1) : host; }

bool is_loopback_host(std::string_view host) {
  constexpr std::string_view name = "localhost";
  if (const auto address = ipv6(host)) return IN6_IS_ADDR_LOOPBACK(&*address);
  host = without_dot(host);
  if (host.starts_with("127.")) return is_ipv4(host);
  if (host.size() <= name.size()) return same_word(host, name);
  return host.size() > name.size() + 1 && host[host.size() - name.size() - 1] == '.' && same_word(host.substr(host.size() - name.size()), name);
}

// The authority of a web origin. Empty when it is not one.
std::string_view authority_of(std::string_view origin) {
  for (const std::string_view scheme : {"http://", "https://"})
    if (same_word(origin.substr(0, scheme.size()), scheme) && is_authority(origin.substr(scheme.size()))) return origin.substr(scheme.size());
  return "";
}

bool has_any(const std::vector<std::string>& allowed) { return std::ranges::find(allowed, "*") != allowed.end(); }

}  // namespace

bool same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

bool is_authority(std::string_view text) { return host_of(text).has_value(); }

bool is_host_name(std::string_view text) { return host_of(text) == text; }

bool is_web_origin(std::string_view text) { return !authority_of(text).empty(); }

bool allows_host(const std::vector<std::string>& allowed, std::string_view authority) {
  if (has_any(allowed)) return true;
  const auto host = host_of(authority);
  if (!host) return false;
  return is_loopback_host(*host) || std::ranges::any_of(allowed, [&](const auto& a) { return same_word(without_dot(a), without_dot(*host)); });
}

std::string_view allowed_origin(const std::vector<std::string>& allowed, std::string_view origin) {
  if (has_any(allowed)) return "*";
  const auto host = host_of(authority_of(origin));
  const bool loopback = host && is_loopback_host(*host);
  return loopback || std::ranges::any_of(allowed, [&](const auto& a) { return same_word(a, origin); }) ? origin : "";
}

}  // namespace teracell::server
