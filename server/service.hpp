// What all routes stand on: the grids, the caches, and the one way to answer with something made from a grid.
#pragma once
#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <set>

#include "server/grids.hpp"
#include "server/http.hpp"
#include "server/target.hpp"
#include "store/shared_cache.hpp"

namespace teracell {

// A chunk among those of all grids.
struct ChunkPlace {
  uint64_t grid;  // ServedGrid::number
  ChunkKey chunk;
  friend bool operator==(const ChunkPlace&, const ChunkPlace&) = default;
};
struct ChunkPlaceHash {
  size_t operator()(const ChunkPlace& p) const;
};

struct ServiceOptions {
  std::vector<std::filesystem::path> named;  // files and folders
  size_t cache_bytes = size_t{256} << 20;    // a sixteenth for the index, the rest for decoded chunks; besides, an eighth for answers, which are small
  uint64_t max_pixels = uint64_t{1} << 26;   // of one picture
  bool anybody = true;                       // may have the answers: caches on the way may keep them for others
  std::function<void(const std::string&)> complain;  // gets what is found damaged, each thing once; any thread
};

// Threads share it.
class Service {
 public:
  explicit Service(ServiceOptions options);
  const ServiceOptions& options() const { return options_; }
  Grids& grids() { return *grids_; }

  // How an answer is made.
  struct Recipe {
    const char* route = "other";  // for the metrics
    std::string content_type;
    bool keep = true;             // in the cache
    bool compress = false;        // with gzip, for clients that accept it: what is not compressed already
    std::function<std::string()> make;
    std::string address = {};     // that it holds, if any: then it is another answer for another address
  };
  // The answer, or 304 when the client has it, without making it. It may be kept for ever when the address names this
  // version of the grid ("v=<hash>" in its query), else it must be asked about each time. Throws HttpError 404 for a
  // version that is not served any more, and what make() throws. REQUIRES: what is made depends on the grid and on
  // request.target alone, unless keep is false.
  Response answer(const Request& request, const Target& target, const ServedGrid& grid, const Recipe& recipe);
  // What answer() gave for the same address, if it is still kept.
  std::optional<Response> recall(const Request& request);
  bool keeps(const Request& request) { return kept(request) != nullptr; }  // whether it is; no hit

  struct Counters {
    std::atomic<uint64_t> reads{0}, bytes{0};  // of the files: chunks, index pages
    std::atomic<uint64_t> damaged{0};          // requests that met a damaged chunk
  };
  const Counters& counters() const { return *counters_; }
  // A request met bytes that can't be read or are damaged: counts it, and complains unless that was done before.
  void damaged(const std::string& message);
  // It met a file that the grids have complained of.
  void unreadable() { counters_->damaged.fetch_add(1, std::memory_order_relaxed); }
  using ChunkCache = SharedCache<ChunkPlace, Chunk, ChunkPlaceHash>;
  using AnswerCache = SharedCache<std::string, Response>;  // by grids().epoch(), encoding and target
  ChunkCache& chunks() { return *chunks_; }
  AnswerCache& answers() { return *answers_; }
  IndexCache& index() { return *index_; }

 private:
  void complain(const std::string& message);
  AnswerCache::Pointer kept(const Request& request);

  const ServiceOptions options_;
  std::shared_ptr<Counters> counters_;
  std::shared_ptr<ChunkCache> chunks_;  // readers keep it alive, and the next
  std::shared_ptr<IndexCache> index_;
  std::unique_ptr<AnswerCache> answers_;
  std::mutex complaints_mutex_;
  std::set<std::string> complaints_;
  std::unique_ptr<Grids> grids_;  // last: it looks at files, and complains, on a thread of its own
};

}  // namespace teracell
