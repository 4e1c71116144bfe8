#include "server/http/clients.hpp"

#include <algorithm>

namespace teracell::server {

std::shared_ptr<Client> Clients::at(const std::string& address) {
  const std::string name = client_name(address);
  std::lock_guard lock(mutex_);
  if (clients_.size() >= swept_at_) {
    std::erase_if(clients_, [](const auto& entry) { return entry.second.expired(); });
    swept_at_ = std::max<size_t>(64, 2 * clients_.size());
  }
  std::weak_ptr<Client>& entry = clients_[name];
  std::shared_ptr<Client> client = entry.lock();
  if (!client) entry = client = std::make_shared<Client>();
  return client;
}

std::string address_name(const boost::asio::ip::address& address) {
  if (!address.is_v6() || !address.to_v6().is_v4_mapped()) return address.to_string();
  return boost::asio::ip::make_address_v4(boost::asio::ip::v4_mapped, address.to_v6()).to_string();
}

std::string client_name(const std::string& text) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(text, error);
  if (error || !address.is_v6()) return text;
  if (address.to_v6().is_v4_mapped() || address.to_v6().is_link_local()) return address_name(address);
  auto bytes = address.to_v6().to_bytes();
  std::fill(bytes.begin() + 8, bytes.end(), uint8_t{0});
  return boost::asio::ip::address_v6(bytes).to_string();
}

std::string last_forwarded(std::string_view field) {
  field.remove_prefix(std::min(field.rfind(',') + 1, field.size()));
  while (field.starts_with(' ')) field.remove_prefix(1);
  while (field.ends_with(' ')) field.remove_suffix(1);
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(std::string(field), error);
  return error ? "" : address_name(address);
}

}  // namespace teracell::server
