// From what a person types to bytes: the name of a file, or an address such as https://host/g.tcell or s3://bucket/g.tcell. A new scheme
// is a file that defines its SourceScheme, and a line here. The library teracell::remote has the function and the schemes: a program that
// reads files alone links teracell::store, and knows no HTTP.
#pragma once
#include <memory>
#include <string>
#include <string_view>

#include "store/base/file.hpp"

// clang-format off
#define TERACELL_SOURCE_SCHEMES(scheme) \
  scheme(kHttps) \
  scheme(kHttp) \
  scheme(kS3)
// clang-format on

namespace teracell::inline store {

class BlockCache;

inline constexpr uint64_t kMostFetches = 6;  // requests at once for one thread that reads from an address: so many connections are kept

struct SourceOptions {
  std::string cache_dir;                           // a folder that keeps what was read; empty: none
  uint64_t cache_dir_bytes = uint64_t{1} << 30;    // how much it keeps
  std::shared_ptr<BlockCache> blocks;              // the memory for what was read; null: each source has 64 MB of its own
  std::string endpoint;                            // the URL of a store that speaks S3; empty: that of Amazon
  bool allow_http = false;                         // to hosts other than this machine
  double timeout = 15;                             // seconds without a byte after which a request is tried again
};

struct SourceScheme {
  std::string_view name;  // "https"
  std::unique_ptr<ByteSource> (*open)(const std::string& address, const SourceOptions& options);
};

#define DECLARED(name) extern const SourceScheme name;
TERACELL_SOURCE_SCHEMES(DECLARED)
#undef DECLARED

// Whether a name begins with a scheme and "://".
bool is_address(std::string_view name);

// Memory for what is read from addresses, for sources that are to share it.
std::shared_ptr<BlockCache> make_block_cache(size_t bytes);

// Opens a file or an object. Throws UsageError for an address that is no good, IoError for what can't be opened.
std::unique_ptr<ByteSource> open_source(const std::string& name, const SourceOptions& options);

}  // namespace teracell::store
