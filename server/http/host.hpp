// Which names a server goes by, and which web pages may read its answers. Any page can make its own name resolve to 127.0.0.1 and
// then read what a server on its visitor's machine answers (DNS rebinding). The Host field still holds the page's name: a server
// that answers only to its own names is safe. Pure.
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace teracell::server {

bool same_word(std::string_view a, std::string_view b);  // capitals don't matter

// What a Host field may hold: a name, an IPv4 address or an IPv6 address in brackets, and perhaps a port (RFC 9110, 7.2, with the
// grammar of RFC 3986, 3.2.2). It can't be empty: an address of the web always has a host.
bool is_authority(std::string_view text);
bool is_host_name(std::string_view text);   // an authority without a port
bool is_web_origin(std::string_view text);  // "https://example.org:8443"

// In both lists "*" stands for any. Loopback is always allowed: localhost, names below it, 127.0.0.0/8 and [::1], at any port.
// Capitals don't matter.
bool allows_host(const std::vector<std::string>& allowed, std::string_view authority);  // `allowed`: without ports
// What Access-Control-Allow-Origin has to say: "*", or the origin; "" when pages from there may not read answers.
std::string_view allowed_origin(const std::vector<std::string>& allowed, std::string_view origin);

}  // namespace teracell::server
