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

// The *.tcell of a folder by name; nothing when it can't be read.
std::vector<std::filesystem::path> grids_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  std::error_code error;
  for (auto it = std::filesystem::directory_iterator(folder, error); !error && it != std::filesystem::directory_iterator(); it.increment(error))
    if (it->path().extension() == ".tcell" && it->is_regular_file(error)) out.push_back(it->path());
  std::ranges::sort(out);
  return out;
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
  if (place.there && place.stamp == stamp) return;
  place.there = true;
  place.stamp = stamp;
  ++epoch_;
  try {
    const uint64_t number = next_number_++;
    auto file = open_(path, number);
    const std::string hash = file->hash();
    place.grid = std::make_shared<const ServedGrid>(ServedGrid{place.id, number, hash, std::move(file)});
  } catch (const Error& e) {
    place.grid = nullptr;
    place.error = e.what();
  }
}

void Grids::refresh() {
  const uint64_t now = steady_milliseconds();
  if (refreshed_ != 0 && now < refreshed_ + kEveryMilliseconds) return;
  refreshed_ = now;
  order_.clear();
  for (auto& [path, place] : places_)
    if (struct stat s; stat(path.c_str(), &s) != 0) lose(path);
  for (const auto& path : named_) {
    std::error_code error;
    const bool folder = std::filesystem::is_directory(path, error);
    for (const auto& file : folder ? grids_in(path) : std::vector{path}) {
      look(file);
      if (std::ranges::find(order_, file) == order_.end()) order_.push_back(file);
    }
  }
}

uint64_t Grids::epoch() {
  if (steady_milliseconds() >= refreshed_ + kEveryMilliseconds) {
    std::lock_guard lock(mutex_);
    refresh();
  }
  return epoch_;
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
