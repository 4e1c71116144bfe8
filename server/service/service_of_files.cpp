// A service of files, folders and addresses: what a page has no use for.
#include "server/service/grids.hpp"
#include "server/service/open_files.hpp"
#include "server/service/service.hpp"
#include "store/remote/cached_source.hpp"
#include "store/remote/sources.hpp"

namespace teracell::server {

Service::Service(ServiceOptions options) : Service(std::move(options), nullptr) {
  const auto open = [this, files = std::make_shared<OpenFiles>(options_.open_files)](const std::filesystem::path& path, uint64_t number) {
    std::unique_ptr<ByteSource> source;
    if (is_address(path.string())) source = open_source(path.string(), options_.source);
    else source = std::make_unique<ReopenedFile>(path, files);
    return this->open(std::move(source), number);
  };
  grids_ = std::make_unique<Grids>(
      options_.named, open, [this](const std::string& message) { complain(message); }, fractions_);
}

std::vector<CacheState> Service::caches() const {
  std::vector<CacheState> out = {{"chunks", chunks_->counts()},       {"index", index_->counts()},   {"answers", answers_.counts()},
                                 {"fractions", fractions_->counts()}, {"views", prepared_.counts()}, {"refined", refined_.counts()}};
  if (options_.source.blocks) out.push_back({"blocks", options_.source.blocks->counts()});
  return out;
}

}  // namespace teracell::server
