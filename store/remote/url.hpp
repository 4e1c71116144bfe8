// Addresses: what they are made of, and which of them may be asked.
#pragma once
#include <string>
#include <string_view>

namespace teracell::inline store {

struct Url {
  std::string scheme, host, port, path, query;  // the scheme in lower case; the port is that of the scheme if the address has none
  std::string text;                             // the whole, with everything encoded and without a fragment
  std::string origin() const { return scheme + "://" + host + ":" + port; }
  // For messages: without the query, which may hold a signature.
  std::string shown() const;
};
// Throws UsageError: not an address, or one with a name or a password in it. An address may be relative to `base`, if there is one.
Url parse_url(const std::string& address, const std::string& base = "");

bool is_loopback(const std::string& host);

// Every byte of a path but letters, digits and - . _ ~ / as %XX, as signatures of S3 want it.
std::string encoded_path(std::string_view path);

}  // namespace teracell::store
