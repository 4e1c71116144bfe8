#include "server/grids.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "server/http.hpp"

namespace teracell {
namespace {

constexpr uint64_t kEveryMilliseconds = 1000;

uint64_t steady_milliseconds() {
  return static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now().time_since_epoch()).count()) + 1;
}

// The *.tcell of a folder by name. None when it can't be read.
std::optional<std::vector<std::filesystem::path>> grids_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  std::error_code error, of_file;
  for (auto it = std::filesystem::directory_iterator(folder, error); !error && it != std::filesystem::directory_iterator(); it.increment(error))
    if (it->path().extension() == ".tcell" && it->is_regular_file(of_file)) out.push_back(it->path());
  if (error) return std::nullopt;
  std::ranges::sort(out);
  return out;
}

// Clients get to see what is wrong, but no folder of this machine.
std::string without_folder(std::string message, const std::filesystem::path& path) {
  for (size_t at; (at = message.find(path.string())) != std::string::npos;) message.replace(at, path.string().size(), path.filename().string());
  return message;
}

}  // namespace

Grids::Grids(std::vector<std::filesystem::path> named, Open open) : named_(std::move(named)), open_(std::move(open)) {
  for (const auto& path : named_)
    if (!std::filesystem::is_directory(path) && !std::filesystem::is_regular_file(path))
      throw UsageError(fmt::format("{}: expected a .tcell file or a folder, found {}", path.string(), std::filesystem::exists(path) ? "something else" : "nothing"));
  std::lock_guard lock(mutex_);
  refresh();
  for (const auto& path : named_)
    if (const auto it = places_.find(path); it != places_.end() && !it->second.grid) throw FormatError(it->second.error);
}

std::string Grids::new_id(const std::filesystem::path& path) const {
  const std::string stem = path.stem().string();
  const auto taken = [&](const std::string& id) { return std::ranges::any_of(places_, [&](const auto& p) { return p.second.id == id; }); };
  std::string id = stem;
  for (int n = 2; taken(id); ++n) id = fmt::format("{}-{}", stem, n);
  return id;
}

void Grids::lose(const std::filesystem::path& path) {
  const auto it = places_.find(path);
  if (it == places_.end() || !it->second.there) return;
  it->second.there = false;
  it->second.grid = nullptr;
  ++epoch_;
}

void Grids::look(const std::filesystem::path& path) {
  struct stat s;
  if (stat(path.c_str(), &s) != 0 || !S_ISREG(s.st_mode)) {
    lose(path);
    return;
  }
  auto it = places_.find(path);
  if (it == places_.end()) it = places_.emplace(path, Place{new_id(path)}).first;
  Place& place = it->second;
  const Stamp stamp{s.st_dev, s.st_ino, static_cast<uint64_t>(s.st_size), int64_t{s.st_mtim.tv_sec} * 1000000000 + s.st_mtim.tv_nsec};
  if (place.there && place.stamp == stamp && place.grid) return;  // one that could not be opened is tried again
  const bool was_there = place.grid != nullptr;
  place.there = true;
  place.stamp = stamp;
  place.error = "its file could not be opened";
  try {
    const uint64_t number = next_number_++;
    auto file = open_(path, number);
    const std::string hash = file->hash();
    place.grid = std::make_shared<const ServedGrid>(ServedGrid{place.id, number, hash, std::move(file)});
  } catch (const std::exception& e) {
    place.grid = nullptr;
    place.error = without_folder(e.what(), path);
  }
  if (place.grid || was_there) ++epoch_;
}

void Grids::refresh() {
  const uint64_t now = steady_milliseconds();
  if (refreshed_ != 0 && now < refreshed_ + kEveryMilliseconds) return;
  refreshed_ = now;
  std::vector<std::filesystem::path> order;
  for (auto& [path, place] : places_)
    if (struct stat s; stat(path.c_str(), &s) != 0) lose(path);
  for (const auto& path : named_) {
    std::error_code error;
    const bool folder = std::filesystem::is_directory(path, error);
    // A folder that can't be read just now keeps what it had: clients would take a 404 for empty cells.
    if (auto found = folder ? grids_in(path) : std::nullopt) listed_[path] = std::move(*found);
    for (const auto& file : folder || listed_.contains(path) ? listed_[path] : std::vector{path}) {
      look(file);
      if (std::ranges::find(order, file) == order.end()) order.push_back(file);
    }
  }
  order_ = std::move(order);
}

uint64_t Grids::epoch() {
  if (steady_milliseconds() >= refreshed_ + kEveryMilliseconds) {
    std::lock_guard lock(mutex_);
    refresh();
  }
  return epoch_;
}

std::optional<uint64_t> Grids::epoch_of(const ServedGrid& grid) {
  std::lock_guard lock(mutex_);
  for (const auto& [path, place] : places_)
    if (place.grid.get() == &grid) return epoch_;
  return std::nullopt;
}

std::shared_ptr<const ServedGrid> Grids::find(const std::string& id) {
  std::lock_guard lock(mutex_);
  refresh();
  for (const auto& path : order_) {
    const auto it = places_.find(path);
    if (it == places_.end() || it->second.id != id || !it->second.there) continue;
    if (!it->second.grid) throw HttpError(500, "unreadable", it->second.error);
    return it->second.grid;
  }
  throw not_found(fmt::format("there is no grid '{}'", id.substr(0, 64)));
}

std::vector<std::shared_ptr<const ServedGrid>> Grids::all() {
  std::lock_guard lock(mutex_);
  refresh();
  std::vector<std::shared_ptr<const ServedGrid>> out;
  for (const auto& path : order_)
    if (const auto it = places_.find(path); it != places_.end() && it->second.grid) out.push_back(it->second.grid);
  return out;
}

}  // namespace teracell
