// What all routes use: the grids, the caches, and the one way to answer with something made from a grid.
#pragma once
#include <atomic>
#include <functional>
#include <mutex>
#include <optional>
#include <set>

#include "server/render/prepared.hpp"
#include "server/service/counted_source.hpp"
#include "server/service/grid_list.hpp"
#include "server/service/message.hpp"
#include "server/service/refined_grids.hpp"
#include "server/service/target.hpp"
#include "store/base/lru_cache.hpp"
#include "store/read/kept_chunks.hpp"
#include "store/remote/sources.hpp"

namespace teracell::server {

struct ServiceOptions {
  std::vector<std::filesystem::path> named;  // files, folders and addresses
  size_t cache_bytes = size_t{256} << 20;    // 1/16 for index pages, the rest for decoded chunks; on top of this, answers and fractions
                                           // take up to 1/8 each, what pictures in three dimensions share 1/4, and refined grids 1/4
  uint64_t max_pixels = uint64_t{1} << 26;  // of one picture
  size_t open_files = 256;  // descriptors of grids that are kept
  bool anybody = true;  // answers are for everybody, so proxies may keep them
  std::function<void(const std::string&)> complain;  // called with each damage that is found, once, on any thread
  SourceOptions source = {};  // for addresses
};

// What a cache counts, for /metrics.
struct CacheState {
  const char* name;  // "chunks", "answers"
  CacheCounts counts;
};

// Threads share it.
class Service {
 public:
  // Of what `options.named` has (service_of_files.cpp).
  explicit Service(ServiceOptions options);
  // Of what the caller publishes.
  Service(ServiceOptions options, std::unique_ptr<GridList> grids);
  const ServiceOptions& options() const { return options_; }
  GridList& grids() { return *grids_; }
  // The reader of the grid with this number, which uses the caches.
  std::unique_ptr<const GridReader> open(std::unique_ptr<ByteSource> source, uint64_t number);
  const std::shared_ptr<FractionCache>& fractions() { return fractions_; }

  // How to make an answer.
  struct Recipe {
    const char* route = "other";  // for the metrics
    std::string content_type;
    bool cacheable = true;
    bool compress = false;  // with gzip, for clients that accept it; false for what is compressed already
    std::function<std::string()> make;
    std::function<std::unique_ptr<Parts>()> parts = {};  // in place of make(), for what may be large; they may refer to the grid
    std::string address = {};  // set when the answer contains its own address, or something else than the grid tells: its ETag depends on it
  };
  // The answer; or status 304, without making it, when the client has it. An answer of more than kWhole bytes that comes in parts has
  // its first ones made, and is not kept. Clients may keep it for ever when the address names
  // this version of the grid ("v=<hash>" in its query); otherwise they must ask each time. Throws HttpError 404 for a version
  // that is no longer served, and what make() throws. REQUIRES: the answer depends on the grid and on request.target alone,
  // unless it is not cacheable.
  Response answer(const Request& request, const Target& target, const std::shared_ptr<const ServedGrid>& grid, const Recipe& recipe);
  static constexpr size_t kWhole = size_t{1} << 18;
  // The earlier answer to the same address, if the cache still has it; counted as a hit.
  std::optional<Response> from_cache(const Request& request);
  bool is_cached(const Request& request) { return find_cached(request) != nullptr; }  // not counted as a hit

  const ReadCounters& counters() const { return *counters_; }
  // To be called when a request met bytes that can't be read or are damaged: counts it, and complains the first time.
  void damaged(const std::string& message);
  // To be called when a request met a file that the grids have complained of.
  void unreadable() { counters_->damaged.fetch_add(1, std::memory_order_relaxed); }
  using AnswerCache = LruCache<std::string, Response>;  // the key: grids().epoch(), encoding and target
  using PreparedCache = LruCache<std::string, Prepared>;  // the key: ServedGrid::number, level and labels
  KeptChunks::Memory& chunks() { return *chunks_; }
  AnswerCache& answers() { return answers_; }
  IndexCache& index() { return *index_; }
  PreparedCache& prepared() { return prepared_; }
  RefinedGrids& refined() { return refined_; }
  // All of them, and what was read from addresses (service_of_files.cpp).
  std::vector<CacheState> caches() const;

 private:
  void complain(const std::string& message);
  AnswerCache::Pointer find_cached(const Request& request);
  Response head_of(const Target& target, const ServedGrid& grid, const Recipe& recipe, bool gzip) const;
  Response made(Response r, const std::shared_ptr<const ServedGrid>& grid, const Recipe& recipe, bool gzip);

  const ServiceOptions options_;
  std::shared_ptr<ReadCounters> counters_;
  std::shared_ptr<KeptChunks::Memory> chunks_;  // shared with the readers, as are the counters and the index
  std::shared_ptr<IndexCache> index_;
  std::shared_ptr<FractionCache> fractions_;
  AnswerCache answers_;
  PreparedCache prepared_;
  RefinedGrids refined_;
  std::mutex complaints_mutex_;
  std::set<std::string> complaints_;
  std::unique_ptr<GridList> grids_;  // last: it complains when it looks at files, which others may make it do
};

}  // namespace teracell::server
