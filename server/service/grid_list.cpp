#include "server/service/grid_list.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "server/service/message.hpp"
#include "store/text/text.hpp"

namespace teracell::server {
namespace {

// UTF-8 without control characters, and neither "." nor "..", which clients resolve, and not too long: what is not UTF-8 takes up to three
// times as many bytes.
std::string addressable(std::string_view stem) {
  std::string out = utf8_of(stem);
  std::ranges::replace_if(
      out, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '_');
  if (out.empty()) out = "grid";  // of an address that ends with a slash
  if (out == "." || out == "..") std::ranges::replace(out, '.', '_');
  return std::string(first_bytes(out, kMostStem));
}

}  // namespace

std::shared_ptr<const ServedGrid> served_grid(std::string id, uint64_t number, std::unique_ptr<const GridReader> reader,
                                              const std::shared_ptr<FractionCache>& fractions, std::filesystem::path path,
                                              std::optional<int64_t> modified) {
  std::unique_ptr<const FractionReader> shares;
  if (find_fractions(reader->meta())) shares = std::make_unique<const FractionReader>(*reader, fractions);
  std::string hash = reader->hash();
  return std::make_shared<const ServedGrid>(
      ServedGrid{std::move(id), number, std::move(hash), std::move(reader), std::move(path), modified, std::move(shares)});
}

std::string grid_id(std::string_view stem, const std::set<std::string>& taken) {
  const std::string plain = addressable(stem);
  std::string id = plain;
  for (int n = 2; taken.contains(id); ++n) id = fmt::format("{}-{}", plain, n);
  return id;
}

void GridList::publish(const std::vector<Entry>& entries) {
  auto next = std::make_shared<Snapshot>();
  for (const Entry& entry : entries)
    if (next->by_id.try_emplace(entry.id, entry).second && entry.grid) next->readable.push_back(entry.grid);
  if (next->by_id == snapshot_->by_id && next->readable == snapshot_->readable) return;
  next->epoch = epoch_ + 1;
  std::lock_guard lock(mutex_);
  epoch_ = next->epoch;
  snapshot_ = std::move(next);
}

std::shared_ptr<const GridList::Snapshot> GridList::snapshot() const {
  std::lock_guard lock(mutex_);
  return snapshot_;
}

std::optional<uint64_t> GridList::epoch_of(const ServedGrid& grid) const {
  const auto current = snapshot();
  const auto it = current->by_id.find(grid.id);
  if (it == current->by_id.end() || it->second.grid.get() != &grid) return std::nullopt;
  return current->epoch;
}

std::shared_ptr<const ServedGrid> GridList::find(const std::string& id) const {
  const auto current = snapshot();
  const auto it = current->by_id.find(id);
  if (it == current->by_id.end()) throw not_found(fmt::format("there is no grid '{}'", id.substr(0, 64)));
  if (!it->second.grid) throw HttpError(500, "unreadable", it->second.error);
  return it->second.grid;
}

std::vector<std::shared_ptr<const ServedGrid>> GridList::all() const { return snapshot()->readable; }

std::vector<GridList::Unreadable> GridList::unreadable() const {
  std::vector<Unreadable> out;
  const auto current = snapshot();
  for (const auto& [id, entry] : current->by_id)
    if (!entry.grid) out.push_back({id, entry.error});
  return out;
}

}  // namespace teracell::server
