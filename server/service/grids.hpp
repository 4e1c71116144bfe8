// The grids that are served: files named at the start, and every *.tcell directly in a folder named there. No request waits for a disk: a
// caller gets what was found by the last look, and GridsWatch (grids_watch.hpp) looks twice per second. A file that is replaced, added or
// removed is noticed by the next look; a caller that holds the old grid goes on reading it while its descriptor is kept. A file that can't be
// opened is not tried at each look: not before it changes if it breaks the format, or else after pauses that grow.
//
// A grid may lie behind an address. Its host is asked now and then whether it was replaced. Cells of two versions never mix,
// since a source notices by itself when its object is another one: what is asked here is how long answers of the old one are given.
#pragma once
#include <atomic>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "server/service/grid_list.hpp"

namespace teracell::server {

// How many files are served to begin with; those that can't be found count as none.
size_t count_grids(const std::vector<std::filesystem::path>& named);

// Threads share it.
class Grids : public GridList {
 public:
  // Makes the reader of a file; `number` is the grid's.
  using Open = std::function<std::unique_ptr<const GridReader>(const std::filesystem::path&, uint64_t number)>;
  using Complain = std::function<void(const std::string&)>;

  // Throws UsageError for a path that is neither a folder nor a file, IoError for a folder that can't be read, FormatError for
  // a named file that can't be opened. For a file in a folder, or one that can't be read later, `complain` is called instead, on
  // any thread: once, when the file has stopped changing. `fractions`: the memory for those of all grids; null: 32 MiB.
  Grids(const std::vector<std::filesystem::path>& named, Open open, Complain complain, std::shared_ptr<FractionCache> fractions = nullptr);

  void look(bool anew = false) override;
  // Threads that call it at the same time share the answers.
  void recheck() override;
  bool has_addresses() const override;

 private:
  struct WatchedFile {
    std::string id;
    uint64_t seen = 0;  // the number of the last look that found it
    FileState state;
    std::shared_ptr<const ServedGrid> grid;  // null: `error` says why
    std::string error;
    int failures = 0;       // to open it in this state
    uint64_t next_try = 0;  // the number of a look
  };
  struct ServedPath {
    std::filesystem::path path;
    bool folder, address;
    std::vector<std::filesystem::path> files;  // the file itself, or what the folder held when it was last readable
    std::string error;                         // why the folder can't be read now
  };
  void list(ServedPath& served);
  WatchedFile& watched(const std::filesystem::path& path);
  void open_address(const std::filesystem::path& path);
  WatchedFile* check_file(const std::filesystem::path& path, bool anew);  // null when it is not there
  void open(const std::filesystem::path& path, WatchedFile& file, const FileState& state);
  std::shared_ptr<const ServedGrid> opened(const std::filesystem::path& path, const std::string& id, uint64_t number,
                                           std::optional<int64_t> modified) const;
  void forget_gone();

  const Open open_;
  const Complain complain_;
  const std::shared_ptr<FractionCache> fractions_;

  std::mutex looking_;  // guards the members down to rechecks_, which only look() uses
  std::vector<ServedPath> served_;
  std::map<std::filesystem::path, WatchedFile> files_;  // files that are gone are kept, with their ids
  std::set<std::string> ids_;                      // of files_
  uint64_t looks_ = 0, next_number_ = 1;

  std::atomic<uint64_t> rechecks_ = 0;  // that were asked for
  std::mutex rechecking_;               // one thread asks the hosts at a time; guards the next one
  uint64_t rechecked_ = 0;              // rechecks_ when the last one of them began
};

}  // namespace teracell::server
