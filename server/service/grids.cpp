#include "server/service/grids.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <cerrno>

#include <fmt/format.h>

#include "server/service/message.hpp"
#include "store/base/wanted.hpp"
#include "store/remote/sources.hpp"
#include "store/text/text.hpp"

namespace teracell::server {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kLongestPause = 120;  // looks
constexpr size_t kMostGone = 1000;  // files that are gone, and whose ids are still reserved for them

// The *.tcell files of a folder, sorted by name.
std::vector<fs::path> grids_in(const fs::path& folder, std::error_code& error) {
  std::vector<fs::path> out;
  std::error_code of_file;
  for (auto it = fs::directory_iterator(folder, error); !error && it != fs::directory_iterator(); it.increment(error))
    if (it->path().extension() == ".tcell" && it->is_regular_file(of_file)) out.push_back(it->path());
  std::ranges::sort(out);
  return out;
}

// An address without its query, which may hold a signature; the name of a file as it is.
fs::path shown(const fs::path& path) {
  const std::string text = path.string();
  return is_address(text) && !text.starts_with("s3:") ? fs::path(text.substr(0, text.find_first_of("?#"))) : path;
}

// A message about a file, as clients see it: without the folders of this machine.
std::string without_folder(std::string message, const fs::path& path) {
  const std::string whole = shown(path).string(), name = shown(path).filename().string();
  for (size_t at = 0; (at = message.find(whole, at)) != std::string::npos; at += name.size()) message.replace(at, whole.size(), name);
  return message;
}

// The same message as the operator of the server sees it: with the folder, since several may be served.
std::string with_folder(const std::string& message, const fs::path& path) {
  const std::string name = shown(path).filename().string();
  return shown(path).string() + (message.starts_with(name + ":") ? message.substr(name.size()) : ": " + message);
}

}  // namespace

size_t count_grids(const std::vector<fs::path>& named) {
  size_t n = 0;
  std::error_code ignored;
  for (const fs::path& path : named) n += fs::is_directory(path, ignored) ? grids_in(path, ignored).size() : 1;
  return n;
}

// `modified`: none for an address.
std::shared_ptr<const ServedGrid> Grids::opened(const fs::path& path, const std::string& id, uint64_t number, std::optional<int64_t> modified) const {
  return served_grid(id, number, open_(path, number), fractions_, modified ? path : fs::path(), modified);
}

Grids::Grids(const std::vector<fs::path>& named, Open open, Complain complain, std::shared_ptr<FractionCache> fractions)
    : open_(std::move(open)),
      complain_(std::move(complain)),
      fractions_(fractions ? std::move(fractions) : std::make_shared<FractionCache>(CellChunks<MixedCells>::kMemory)) {
  for (const auto& path : named) {
    if (is_address(path.string())) {
      served_.push_back({path, false, true, {path}, ""});
      WatchedFile& file = watched(path);
      if (file.grid) continue;  // named twice
      file.grid = opened(path, file.id, next_number_++, {});
      continue;
    }
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::status_known(status)) throw IoError(fmt::format("{}: can't be read: {}", path.string(), error.message()));
    if (!fs::is_directory(status) && !fs::is_regular_file(status))
      throw UsageError(
          fmt::format("{}: expected a .tcell file or a folder, found {}", path.string(), fs::exists(status) ? "something else" : "nothing"));
    served_.push_back({path, fs::is_directory(status), false, {path}, ""});
  }
  look();
  for (const ServedPath& served : served_) {
    if (!served.error.empty()) throw IoError(served.error);
    if (served.folder) continue;
    if (const auto it = files_.find(served.path); it != files_.end() && !it->second.grid)
      throw FormatError(with_folder(it->second.error, served.path));
  }
}

bool Grids::has_addresses() const { return std::ranges::any_of(served_, &ServedPath::address); }

void Grids::recheck() {
  const uint64_t mine = ++rechecks_;
  if (std::lock_guard one(rechecking_); rechecked_ < mine) {
    const uint64_t all = rechecks_;
    for (const ServedPath& served : served_)  // which does not change after the constructor, but for the files of folders
      if (served.address) open_address(served.path);
    rechecked_ = all;
  }
  look();
}

// Opens the object of an address if it is not the one that is open. While its host can't be asked, the old one is served.
void Grids::open_address(const fs::path& path) {
  std::shared_ptr<const ServedGrid> old;
  uint64_t number;
  std::string id;
  {
    std::lock_guard lock(looking_);
    old = files_.at(path).grid;
    id = files_.at(path).id;
    number = next_number_++;
  }
  std::shared_ptr<const ServedGrid> next;
  std::string error;
  try {
    if (old && !old->reader().source().was_replaced()) return;
    next = opened(path, id, number, {});
  } catch (const Unwanted&) {
    throw;
  } catch (const FormatError& e) {
    error = e.what();
  } catch (const std::exception& e) {
    if (old) return;
    error = e.what();
  }
  std::lock_guard lock(looking_);
  WatchedFile& file = files_.at(path);
  const std::string message = error.empty() ? "" : shortened(without_folder(error, path));
  if (!message.empty() && message != file.error) complain_(with_folder(message, path));
  file.grid = next;
  file.error = message;
}

void Grids::look(bool anew) {
  std::lock_guard lock(looking_);
  ++looks_;
  std::vector<Entry> found;
  for (ServedPath& served : served_) {
    if (served.folder) list(served);
    for (const auto& path : served.files)
      if (const WatchedFile* file = check_file(path, anew)) found.push_back({file->id, file->grid, file->error});
  }
  forget_gone();
  publish(found);
}

// A folder that can't be read at the moment keeps its files: clients would take status 404 for empty cells.
void Grids::list(ServedPath& served) {
  std::error_code error;
  auto found = grids_in(served.path, error);
  if (!error) served.files = std::move(found);
  else if (looks_ == 1) served.files.clear();
  if (error && served.error.empty() && looks_ > 1) complain_(fmt::format("{}: can't be read: {}", served.path.string(), error.message()));
  served.error = error ? fmt::format("{}: can't be read: {}", served.path.string(), error.message()) : "";
}

// The entry of a path, which is made if there is none.
Grids::WatchedFile& Grids::watched(const fs::path& path) {
  auto it = files_.find(path);
  if (it == files_.end()) {
    it = files_.emplace(path, WatchedFile{grid_id(shown(path).stem().string(), ids_)}).first;
    ids_.insert(it->second.id);
  }
  return it->second;
}

Grids::WatchedFile* Grids::check_file(const fs::path& path, bool anew) {
  if (is_address(path.string())) {
    WatchedFile& file = watched(path);
    file.seen = looks_;
    return &file;
  }
  struct stat s;
  const int error = stat(path.c_str(), &s) == 0 ? 0 : errno;
  if (error == ENOENT || error == ENOTDIR || (error == 0 && !S_ISREG(s.st_mode))) return nullptr;
  WatchedFile& file = watched(path);
  file.seen = looks_;
  if (error != 0) {  // perhaps for a moment only; a file that was opened can still be read
    if (!file.grid) file.error = fmt::format("{}: {}", path.filename().string(), std::generic_category().message(error));
    return &file;
  }
  const FileState state = state_of(s);
  if (file.state != state || (!file.grid && (anew || looks_ >= file.next_try))) open(path, file, state);
  return &file;
}

void Grids::open(const fs::path& path, WatchedFile& file, const FileState& state) {
  if (file.state != state) file.failures = 0;
  file.state = state;
  file.grid = nullptr;
  file.error = "its file could not be opened";
  const auto fail = [&](const std::exception& e, bool for_good) {
    ++file.failures;
    // Even one that breaks the format is tried twice: it may have been half written, and its time need not tell.
    file.next_try = for_good && file.failures > 1 ? ~uint64_t{0} : looks_ + std::min(kLongestPause, uint64_t{1} << std::min(file.failures - 1, 20));
    file.error = shortened(without_folder(e.what(), path));
    if (file.failures == 2) complain_(with_folder(file.error, path));
  };
  try {
    file.grid = opened(path, file.id, next_number_++, file.state.changed / 1'000'000'000);
  } catch (const FormatError& e) {
    fail(e, true);
  } catch (const std::exception& e) {
    fail(e, false);
  }
}

void Grids::forget_gone() {
  std::vector<std::pair<uint64_t, fs::path>> gone;
  for (auto& [path, file] : files_)
    if (file.seen != looks_) {
      file.grid = nullptr;
      gone.emplace_back(file.seen, path);
    }
  if (gone.size() <= kMostGone) return;
  std::ranges::sort(gone);
  gone.resize(gone.size() - kMostGone);  // leaves those that have been gone longest
  for (const auto& [seen, path] : gone) {
    const auto it = files_.find(path);
    ids_.erase(it->second.id);
    files_.erase(it);
  }
}

}  // namespace teracell::server
