#include "server/service/service.hpp"

#include <fmt/format.h>

#include "server/service/deflate.hpp"
#include "store/base/wanted.hpp"
#include "store/text/text.hpp"

namespace teracell::server {
namespace {

// Part of every ETag. Raise it when the server makes other bytes from the same grid.
constexpr int kRevision = 2;

// What follows the first parts of an answer. Keeps its grid, and counts damage.
class Rest final : public Parts {
 public:
  Rest(Service& service, std::shared_ptr<const ServedGrid> grid, std::unique_ptr<Parts> parts)
      : service_(service), grid_(std::move(grid)), parts_(std::move(parts)) {}
  bool append(std::string& out) override {
    try {
      return parts_->append(out);
    } catch (const Replaced&) {
      throw;
    } catch (const FormatError& e) {
      service_.damaged(e.what());
      throw;
    } catch (const IoError& e) {
      service_.damaged(e.what());
      throw;
    }
  }
  size_t memory() const override { return parts_->memory(); }

 private:
  Service& service_;
  const std::shared_ptr<const ServedGrid> grid_;  // before what refers to it
  const std::unique_ptr<Parts> parts_;
};

// An answer that is not kept, so that others who wait for it must make their own.
struct NotKept : Unwanted {
  explicit NotKept(Response r) : Unwanted("the answer is for one request"), response(std::move(r)) {}
  Response response;
};

std::string etag_of(const ServedGrid& grid, const std::string& address, bool gzip) {
  const auto bytes = std::span(reinterpret_cast<const uint8_t*>(address.data()), address.size());
  return fmt::format("\"{}-{}{}{}\"", grid.hash, kRevision, address.empty() ? "" : fmt::format("-{:x}", checksum(bytes)), gzip ? "-gz" : "");
}

std::string cache_key(uint64_t epoch, bool gzip, const std::string& target) {
  std::string key = std::to_string(epoch);
  key += gzip ? 'z' : ' ';
  return key += target;
}

}  // namespace

Service::Service(ServiceOptions options, std::unique_ptr<GridList> grids)
    : options_(std::move(options)),
      counters_(std::make_shared<ReadCounters>()),
      chunks_(std::make_shared<KeptChunks::Memory>(options_.cache_bytes - options_.cache_bytes / 16)),
      index_(std::make_shared<IndexCache>(options_.cache_bytes / 16)),
      fractions_(std::make_shared<FractionCache>(options_.cache_bytes / 8)),
      answers_(options_.cache_bytes / 8),
      prepared_(options_.cache_bytes / 4),
      refined_(options_.cache_bytes / 4),
      grids_(std::move(grids)) {}

std::unique_ptr<const GridReader> Service::open(std::unique_ptr<ByteSource> source, uint64_t number) {
  return std::make_unique<const GridReader>(counted_source(std::move(source), counters_), std::make_shared<KeptChunks>(chunks_, number), index_);
}

Service::AnswerCache::Pointer Service::find_cached(const Request& request) {
  const uint64_t epoch = grids_->epoch();
  if (request.accepts_gzip)
    if (auto gzip = answers_.peek(cache_key(epoch, true, request.target))) return gzip;
  auto plain = answers_.peek(cache_key(epoch, false, request.target));
  return plain && request.accepts_gzip && plain->compressible ? nullptr : plain;
}

std::optional<Response> Service::from_cache(const Request& request) {
  const auto answer = find_cached(request);
  if (!answer) return std::nullopt;
  answers_.hit();
  Response r = *answer;
  if (has_etag(request.if_none_match, r.etag)) r.status = 304, r.body = nullptr;
  return r;
}

// The answer without its body.
Response Service::head_of(const Target& target, const ServedGrid& grid, const Recipe& recipe, bool gzip) const {
  Response r;
  r.route = recipe.route;
  r.content_type = recipe.content_type;
  const std::string* version = target.find("v");
  if (version && *version != grid.hash)
    throw not_found(fmt::format("v: the version of grid '{}' is {}, found '{}': the file was replaced, or the address belongs to another file",
                                grid.id, grid.hash, version->substr(0, 64)));
  r.cache_control = !version || !recipe.address.empty() ? "no-cache"
                    : options_.anybody                  ? "public, max-age=31536000, immutable"
                                                        : "private, max-age=31536000, immutable";
  r.etag = etag_of(grid, recipe.address, gzip);
  r.compressible = recipe.compress && !gzip;
  if (gzip) r.content_encoding = "gzip";
  return r;
}

// `r` with its body, or with the first parts of it and the rest.
Response Service::made(Response r, const std::shared_ptr<const ServedGrid>& grid, const Recipe& recipe, bool gzip) {
  if (recipe.make) {
    std::string text = recipe.make();
    r.body = body_of(gzip ? deflated(text, Wrapping::kGzip) : std::move(text));
    return r;
  }
  std::unique_ptr<Parts> parts = gzip ? gzip_parts(recipe.parts()) : recipe.parts();
  std::string first;
  bool more = true;
  while (more && first.size() < kWhole) more = parts->append(first);
  first.shrink_to_fit();
  r.body = body_of(std::move(first));
  if (more) r.rest = std::make_shared<Rest>(*this, grid, std::move(parts));
  return r;
}

Response Service::answer(const Request& request, const Target& target, const std::shared_ptr<const ServedGrid>& grid, const Recipe& recipe) {
  // Taken before the answer is made: if the grid is replaced meanwhile, the answer is kept under a key that nobody uses.
  const std::optional<uint64_t> epoch = grids_->epoch_of(*grid);
  const bool gzip = recipe.compress && request.accepts_gzip;
  Response r = head_of(target, *grid, recipe, gzip);
  if (has_etag(request.if_none_match, r.etag)) {
    r.status = 304;
    return r;
  }
  if (!recipe.cacheable || !epoch) return made(std::move(r), grid, recipe, gzip);
  const std::string key = cache_key(*epoch, gzip, request.target);
  try {
    return *answers_.get(key, [&] {
      auto answer = std::make_shared<const Response>(made(r, grid, recipe, gzip));
      if (answer->rest) throw NotKept(*answer);
      const size_t bytes = sizeof(Response) + answer->body->capacity() + 3 * key.size() + 256;  // 256: for the other strings
      return std::pair(std::move(answer), bytes);
    });
  } catch (const NotKept& e) {
    return e.response;
  }
}

void Service::damaged(const std::string& message) {
  counters_->damaged.fetch_add(1, std::memory_order_relaxed);
  complain(message);
}

void Service::complain(const std::string& message) {
  constexpr size_t kMostComplaints = 1000;
  std::lock_guard lock(complaints_mutex_);
  if (complaints_.size() >= kMostComplaints) return;
  if (const auto [said, fresh] = complaints_.insert(shortened(message)); fresh && options_.complain) options_.complain(*said);
}

}  // namespace teracell::server
