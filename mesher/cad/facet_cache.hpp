// What the CAD kernel made of files, for the next run. Any number of processes may use the folder at the same time: an entry takes its name
// when it is complete, and whoever makes it makes the same bytes. Each ends with a hash of its bytes and its key, so a damaged one, or one under
// another name, counts as missing.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "store/base/descriptor.hpp"
#include "store/base/spill.hpp"

namespace teracell::mesher {

// Not to be shared by threads.
class FacetCache {
 public:
  // Empty: that of the user. Where it can't be used, entries live in the budget's folder as long as they are open.
  FacetCache(std::filesystem::path folder, const Budget& budget);

  struct Entry {
    Descriptor file;
    uint64_t size;     // without the hash
    std::string hash;  // XXH3-128 of these bytes, 32 hex digits
  };
  std::optional<Entry> find(const std::string& key) const;
  std::optional<std::string> find_text(const std::string& key) const;
  // The entry that `make` writes under the path that it gets, with its hash put behind. Where that fails for the folder, as one that is full, it is
  // called once more for the budget's folder. What `make` throws passes through then, and nothing is left.
  Entry add(const std::string& key, const std::function<void(const std::string& path)>& make) const;
  void add_text(const std::string& key, const std::string& text) const;  // a text that can't be kept is not

  // Held by the process that makes an entry, so that others wait for it, so many seconds at most, instead of making it as well. `waiting` is called
  // now and then, and may throw. Empty: the folder has no locks, or the time is over.
  Descriptor lock(const std::string& key, double seconds, const std::function<void()>& waiting) const;

 private:
  Entry add_in(const std::filesystem::path& folder, const std::string& key, const std::function<void(const std::string& path)>& make) const;
  std::filesystem::path path_of(const std::string& key) const;
  void make_room(const std::string& newest) const;
  std::filesystem::path folder_;  // empty: nothing is kept
  std::filesystem::path other_;  // the budget's
};

}  // namespace teracell::mesher
