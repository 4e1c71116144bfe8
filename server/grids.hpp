// The grids that are served: files named at the start, and every *.tcell directly in a folder named there. A file that is
// replaced, added or removed is noticed without a restart; who holds the old one goes on reading it.
#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "store/reader.hpp"

namespace teracell {

// One file as it was when it was opened. Immutable; threads share it.
struct ServedGrid {
  std::string id;    // a name, never a path: the file's stem, numbered when repeated
  uint64_t number;   // no other file that was ever opened here has it, not even the same one replaced
  std::string hash;  // of the content, for ETags and versioned addresses
  std::unique_ptr<const GridReader> file;
  const GridReader& reader() const { return *file; }
  const Metadata& meta() const { return file->meta(); }
};

class Grids {
 public:
  // Makes the reader of a file; `number` is the grid's.
  using Open = std::function<std::unique_ptr<const GridReader>(const std::filesystem::path&, uint64_t number)>;

  // Throws UsageError for a path that is neither a folder nor a file, or when a named file can't be opened.
  Grids(std::vector<std::filesystem::path> named, Open open);

  // Throws HttpError: 404 when there is no such grid, 500 with what is wrong when its file can't be read.
  std::shared_ptr<const ServedGrid> find(const std::string& id);
  // Another number whenever all() or find() would answer otherwise than before.
  uint64_t epoch();
  // That number, unless the grid is not what find() gives any more.
  std::optional<uint64_t> epoch_of(const ServedGrid& grid);
  // Those that can be read, in the order of the command line, those of a folder by name.
  std::vector<std::shared_ptr<const ServedGrid>> all();

 private:
  // Tells one state of a file from another.
  struct Stamp {
    uint64_t device = 0, inode = 0, size = 0;
    int64_t changed = 0;  // nanoseconds
    friend bool operator==(const Stamp&, const Stamp&) = default;
  };
  struct Place {
    std::string id;
    bool there = true;
    Stamp stamp;
    std::shared_ptr<const ServedGrid> grid;  // null: `error` says why
    std::string error;
  };
  void refresh();                                      // at most once a second; REQUIRES: locked
  void look(const std::filesystem::path& path);        // at one file
  void lose(const std::filesystem::path& path);
  std::string new_id(const std::filesystem::path& path) const;

  const std::vector<std::filesystem::path> named_;
  const Open open_;
  std::mutex mutex_;
  uint64_t next_number_ = 1;
  std::atomic<uint64_t> epoch_ = 0, refreshed_ = 0;    // refreshed_: steady milliseconds, 0 is never
  std::vector<std::filesystem::path> order_;           // of the places, as all() has them
  std::map<std::filesystem::path, std::vector<std::filesystem::path>> listed_;  // of folders, when they could be read last
  std::map<std::filesystem::path, Place> places_;      // those gone keep their ids
};

}  // namespace teracell
