// What the module never does, so that the code for it need not come along: it writes no files, looks for no findings, which lie beside a grid where a
// page cannot look, it compresses no chunks and no answers, and it verifies no files.
#include <algorithm>

#include <zstd.h>

#include "server/service/deflate.hpp"
#include "store/base/spill.hpp"
#include "store/channels/fractions.hpp"
#include "store/channels/links.hpp"
#include "store/check/kept.hpp"
#include "store/format/channel_kinds.hpp"
#include "store/runs/chunk_codec.hpp"

namespace teracell::server {

std::string deflated(std::string_view, Wrapping) { return ""; }
std::unique_ptr<Parts> gzip_parts(std::unique_ptr<Parts> parts) { return parts; }

}  // namespace teracell::server

namespace teracell::inline store {

std::string read_kept_findings(const std::filesystem::path&, const GridReader&) { return ""; }
bool has_kept_findings(const std::filesystem::path&, const GridReader&) { return false; }

// A page has no files: all stays in memory.
std::filesystem::path temporary_folder() { return {}; }
SpillFile::SpillFile(const std::filesystem::path&, uint64_t, bool) : in_memory_(true) {}
void SpillFile::write(uint64_t offset, std::span<const uint8_t> bytes) {
  held_.resize(std::max(held_.size(), static_cast<size_t>(offset) + bytes.size()));
  std::ranges::copy(bytes, held_.begin() + static_cast<ptrdiff_t>(offset));
}
void SpillFile::read(uint64_t offset, std::span<uint8_t> out) const {
  std::copy_n(held_.begin() + static_cast<ptrdiff_t>(offset), out.size(), out.begin());
}

struct ChunkEncoder::Scratch {};
ChunkEncoder::ChunkEncoder() = default;
ChunkEncoder::~ChunkEncoder() = default;
Bytes ChunkEncoder::encode(const RayBlock&, const SetTable&) { return {}; }

// Without what verify() calls.
const ChannelKind kLabelsKind = {kLabels, kRuns, nullptr};
const ChannelKind kFractionsKind = {kFractions, kStretches, nullptr, [](const Channel& channel) { subdivision_of(channel); }};
const ChannelKind kOldFractionsKind = {kFractions, kShares, nullptr, [](const Channel& channel) { subdivision_of(channel); }};
const ChannelKind kLinksKind = {kLinks, kDistances, nullptr};

}  // namespace teracell::store

// Made by those that could write chunks, too, and never used.
ZSTD_CCtx* ZSTD_createCCtx() {
  static char nothing;
  return reinterpret_cast<ZSTD_CCtx*>(&nothing);
}
size_t ZSTD_freeCCtx(ZSTD_CCtx*) { return 0; }
size_t ZSTD_compressBound(size_t) { return 0; }
size_t ZSTD_compressCCtx(ZSTD_CCtx*, void*, size_t, const void*, size_t, int) { return static_cast<size_t>(-1); }

// Only for the message of an exception that nobody catches.
extern "C" char* __cxa_demangle(const char*, char*, size_t*, int* status) {
  *status = -1;
  return nullptr;
}
