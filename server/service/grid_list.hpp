// The grids that are served, as they are at some time. Whoever finds them publishes them: the program looks at files (grids.hpp), the page
// has what it was given.
#pragma once
#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "store/channels/fraction_reader.hpp"

namespace teracell::server {

// One file as it was when it was opened. Immutable; threads share it.
struct ServedGrid {
  std::string id;    // the file's stem as an address can hold it, numbered when two files share it; never a path
  uint64_t number;   // unlike that of any other file opened by this process; a file that is replaced gets another one
  std::string hash;  // of the content, for ETags and versioned addresses
  std::unique_ptr<const GridReader> file;
  std::filesystem::path path;       // empty for an address
  std::optional<int64_t> modified;  // seconds since 1970; none for an address
  std::unique_ptr<const FractionReader> fractions;  // null: the grid has none
  const GridReader& reader() const { return *file; }
  const Metadata& meta() const { return file->meta(); }
};

// Makes its fraction reader, if the grid has fractions. `modified`: none for an address.
std::shared_ptr<const ServedGrid> served_grid(std::string id, uint64_t number, std::unique_ptr<const GridReader> reader,
                                              const std::shared_ptr<FractionCache>& fractions, std::filesystem::path path = {},
                                              std::optional<int64_t> modified = {});
// A file's stem in a form that addresses and JSON can hold, numbered when it is taken.
std::string grid_id(std::string_view stem, const std::set<std::string>& taken);

// Threads share it.
class GridList {
 public:
  virtual ~GridList() = default;

  // Throws HttpError: 404 when there is no such grid, 500 with what is wrong when its file can't be read.
  std::shared_ptr<const ServedGrid> find(const std::string& id) const;
  // Changes whenever the answer of all() or find() changes.
  uint64_t epoch() const { return epoch_; }
  // That number, or none when find() no longer returns this grid.
  std::optional<uint64_t> epoch_of(const ServedGrid& grid) const;
  // The grids that can be read, in the order in which they were published.
  std::vector<std::shared_ptr<const ServedGrid>> all() const;
  // The files that can't be read, by id.
  struct Unreadable {
    std::string id, error;
  };
  std::vector<Unreadable> unreadable() const;

  struct Entry {
    std::string id;
    std::shared_ptr<const ServedGrid> grid;  // null: `error` says why
    std::string error;
    friend bool operator==(const Entry&, const Entry&) = default;
  };
  // From now on these are served; of those that share an id, the first. One thread calls it at a time.
  void publish(const std::vector<Entry>& entries);

  // Looks at the files now. `anew`: tries also files that are not due.
  virtual void look(bool /*anew*/ = false) {}
  // Asks the hosts of all addresses now, and looks at the files.
  virtual void recheck() {}
  virtual bool has_addresses() const { return false; }

 private:
  // What is served at some time. Immutable.
  struct Snapshot {
    std::map<std::string, Entry> by_id;
    std::vector<std::shared_ptr<const ServedGrid>> readable;
    uint64_t epoch = 0;
  };
  std::shared_ptr<const Snapshot> snapshot() const;

  mutable std::mutex mutex_;  // held only while snapshot_ is copied or replaced
  std::shared_ptr<const Snapshot> snapshot_ = std::make_shared<const Snapshot>();
  std::atomic<uint64_t> epoch_ = 0;  // of snapshot_
};

}  // namespace teracell::server
