// Who a client is.
#include "server/http/clients.hpp"

#include "tests/support/test.hpp"

namespace teracell::server {
namespace {

TEST_CASE("A client is one as long as somebody holds it", "[clients]") {
  Clients clients;
  const auto a = clients.at("10.0.0.1");
  CHECK(clients.at("10.0.0.1") == a);
  CHECK(clients.at("10.0.0.2") != a);
  const std::weak_ptr<Client> gone = clients.at("10.0.0.3");
  CHECK(gone.expired());
  for (int i = 0; i < 1000; ++i) clients.at(fmt::format("10.1.{}.{}", i / 256, i % 256));
  CHECK(clients.at("10.0.0.1") == a);
}

TEST_CASE("Addresses of IPv6 with the same first half are one client, and mapped ones of IPv4 are those of IPv4", "[clients]") {
  CHECK(client_name("2001:db8:1:2:3::4") == client_name("2001:db8:1:2:ffff::1"));
  CHECK(client_name("2001:db8:1:2::") != client_name("2001:db8:1:3::"));
  CHECK(client_name("::ffff:10.0.0.1") == "10.0.0.1");
  CHECK(client_name("fe80::1") != client_name("fe80::2"));
  CHECK(client_name("::ffff:10.0.0.1") != client_name("::ffff:10.0.0.2"));
}

TEST_CASE("The nearest proxy's entry of X-Forwarded-For names the client", "[clients]") {
  CHECK(last_forwarded("10.0.0.1") == "10.0.0.1");
  CHECK(last_forwarded("6.6.6.6, 10.0.0.1") == "10.0.0.1");  // what a client sends itself stands before
  CHECK(last_forwarded("6.6.6.6,2001:DB8::1 ") == "2001:db8::1");
  CHECK(last_forwarded("::ffff:10.0.0.1") == "10.0.0.1");
  for (const char* none : {"", "unknown", "10.0.0.1,", "10.0.0.256", "a b"}) CHECK(last_forwarded(none).empty());
}

}  // namespace
}  // namespace teracell::server
