// The schemes of addresses. http:// and https:// are asked as they are; s3://bucket/key is the object of a store that speaks S3, and
// its requests are signed if the usual variables of the environment hold a key.
#include <cstdlib>

#include <fmt/format.h>

#include "store/remote/cached_source.hpp"
#include "store/remote/remote_object.hpp"
#include "store/remote/sources.hpp"
#include "store/text/text.hpp"

namespace teracell::inline store {
namespace {

std::string variable(const char* name) {
  const char* value = std::getenv(name);
  return value == nullptr ? "" : value;
}

std::unique_ptr<ByteSource> cached(RemotePlace place, const SourceOptions& options) {
  place.allow_http = options.allow_http;
  place.timeout = options.timeout;
  const std::string key = place.url.text;
  auto object = std::make_unique<RemoteObject>(std::move(place));
  std::unique_ptr<BlockFolder> disk;
  if (!options.cache_dir.empty() && !object->version().empty())
    disk =
        std::make_unique<BlockFolder>(options.cache_dir, options.cache_dir_bytes, fmt::format("{}\n{}\n{}", key, object->version(), object->size()));
  const uint64_t tail_offset = object->tail_offset();
  Bytes tail = object->tail();
  return std::make_unique<CachedSource>(std::move(object), std::move(disk), CachedSource::Kept{tail_offset, std::move(tail)},
                                        options.blocks ? options.blocks : make_block_cache(CachedSource::kMemory));
}

std::unique_ptr<ByteSource> open_http(const std::string& address, const SourceOptions& options) {
  RemotePlace place;
  place.url = parse_url(address);
  place.name = place.url.shown();
  return cached(std::move(place), options);
}

std::unique_ptr<ByteSource> open_s3(const std::string& address, const SourceOptions& options) {
  const std::string_view rest = std::string_view(address).substr(5);  // s3://
  const size_t slash = rest.find('/');
  const std::string bucket(rest.substr(0, slash)), key(slash == std::string_view::npos ? "" : rest.substr(slash + 1));
  const std::string shown = printable(first_bytes(address, 512));
  if (bucket.empty() || key.empty() || encoded_path(bucket) != bucket)
    throw UsageError(fmt::format("{}: expected an address like s3://bucket/key", shown));
  RemotePlace place;
  place.signing = {variable("AWS_ACCESS_KEY_ID"), variable("AWS_SECRET_ACCESS_KEY"), variable("AWS_SESSION_TOKEN"), variable("AWS_REGION")};
  if (place.signing.region.empty()) place.signing.region = variable("AWS_DEFAULT_REGION");
  if (place.signing.region.empty()) place.signing.region = "us-east-1";
  if (encoded_path(place.signing.region) != place.signing.region) throw UsageError("AWS_REGION: expected a name like eu-central-1");
  const std::string path = encoded_path(key);
  if (!options.endpoint.empty()) {
    std::string endpoint = parse_url(options.endpoint).text;
    if (!parse_url(endpoint).query.empty())
      throw UsageError(fmt::format("{}: expected the address of a store without a query", parse_url(endpoint).shown()));
    while (endpoint.ends_with('/')) endpoint.pop_back();
    place.url = parse_url(fmt::format("{}/{}/{}", endpoint, bucket, path));
  } else if (bucket.find('.') == std::string::npos) {
    place.url = parse_url(fmt::format("https://{}.s3.{}.amazonaws.com/{}", bucket, place.signing.region, path));
  } else {  // its certificate would not fit a name with more dots
    place.url = parse_url(fmt::format("https://s3.{}.amazonaws.com/{}/{}", place.signing.region, bucket, path));
  }
  place.name = shown;
  return cached(std::move(place), options);
}

}  // namespace

std::shared_ptr<BlockCache> make_block_cache(size_t bytes) { return std::make_shared<BlockCache>(bytes); }

extern const SourceScheme kHttps{"https", open_http};
extern const SourceScheme kHttp{"http", open_http};
extern const SourceScheme kS3{"s3", open_s3};

}  // namespace teracell::store
