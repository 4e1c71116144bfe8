// What each client uses of what all share, so that none can use all of it. A client is an address: the one that a connection comes
// from, or the one that a trusted proxy names.
#pragma once
#include <atomic>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <unordered_map>

#include <boost/asio/ip/address.hpp>

namespace teracell::server {

struct Loop;

struct Client {
  std::atomic<uint64_t> connections{0};  // open
  std::atomic<uint64_t> waiting{0};      // requests in the pool, queued or running
  std::atomic<uint64_t> held_bytes{0};   // of answers that it has yet to take
  std::mutex mutex;                      // of the rest
  std::list<Loop*> idle;                 // of each connection that waits for a request: the longest first
  size_t giving_way = 0;                 // the first of them, which are about to be closed
};

// Threads share it.
class Clients {
 public:
  // The same object for the same client for as long as anybody holds it.
  std::shared_ptr<Client> at(const std::string& address);

 private:
  std::mutex mutex_;
  std::unordered_map<std::string, std::weak_ptr<Client>> clients_;
  size_t swept_at_ = 64;  // the number of entries at which those that nobody holds are dropped
};

// The text of an address; one of IPv4 that is mapped into IPv6 is one of IPv4.
std::string address_name(const boost::asio::ip::address& address);
// The name of the client at an address. Addresses of IPv6 that share their first 64 bits are one client: whoever has one of them
// usually has all of them.
std::string client_name(const std::string& address);
// The address in the last entry of an X-Forwarded-For field, which the nearest proxy has added; empty when it is none.
std::string last_forwarded(std::string_view field);

}  // namespace teracell::server
