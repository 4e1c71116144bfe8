#include "tests/support/assembled.hpp"

#include <algorithm>

#include <xxhash.h>
#include <zstd.h>

#include "store/base/zstd_frame.hpp"
#include "store/format/metadata_json.hpp"

namespace teracell::testing {
namespace {

// Cut into blocks of `piece` bytes. A block takes at least 4 bytes, so it bounds the ratio.
Bytes in_blocks(const Bytes& body, size_t piece, int level) {
  ZSTD_CCtx* zstd = ZSTD_createCCtx();
  ZSTD_CCtx_setParameter(zstd, ZSTD_c_compressionLevel, level);
  ZSTD_CCtx_setPledgedSrcSize(zstd, body.size());
  Bytes out(ZSTD_compressBound(body.size()) + 64 + body.size() / piece * 32);
  ZSTD_outBuffer to{out.data(), out.size(), 0};
  for (size_t at = 0; at < body.size() || at == 0; at += piece) {
    const size_t size = std::min(piece, body.size() - at);
    ZSTD_inBuffer from{body.data() + at, size, 0};
    const auto mode = at + size == body.size() ? ZSTD_e_end : ZSTD_e_flush;
    while (ZSTD_compressStream2(zstd, &to, &from, mode) != 0) {
    }
  }
  ZSTD_freeCCtx(zstd);
  out.resize(to.pos);
  return out;
}

}  // namespace

Bytes squeezed(const Bytes& body, uint64_t ratio) {
  Bytes frame = ZstdEncoder().encode(body, body.size() < (1 << 20) ? 19 : 3);
  for (size_t piece = 1 << 17; piece >= 256 && body.size() > ratio * frame.size(); piece -= piece / 8) frame = in_blocks(body, piece, 3);
  return frame;
}

Bytes repeated(const Bytes& unit, size_t times) {
  Bytes out;
  out.reserve(unit.size() * times);
  for (size_t i = 0; i < times; ++i) out.insert(out.end(), unit.begin(), unit.end());
  return out;
}

Assembly::Assembly(Metadata meta) : meta_(std::move(meta)), out_(encode_header()) {
  meta_.levels().clear();
  for (int level = 0; level < meta_.grid.levels(); level += 2) meta_.levels().push_back({level, 0, 0, 0, 0});
}

DirectoryEntry Assembly::append(const Bytes& frame) {
  const DirectoryEntry place{out_.size(), frame.size(), checksum(frame)};
  out_.insert(out_.end(), frame.begin(), frame.end());
  return place;
}

ChunkEntry Assembly::chunk(const Bytes& frame, std::vector<LabelStats> stats) {
  const DirectoryEntry place = append(frame);
  return {place.offset, static_cast<uint32_t>(place.size), place.checksum, {}, std::move(stats)};
}

Bytes Assembly::finish(const At& at, const std::string& report, uint64_t page_ratio) {
  std::vector<std::vector<DirectoryEntry>> directories;
  for (const LevelInfo& level : meta_.levels()) {
    const LevelShape s(meta_, level.level);
    auto& places = directories.emplace_back();
    for (uint64_t page = 0; page < s.pages(); ++page) {
      std::vector<ChunkEntry> entries;
      for (uint32_t slot = 0; slot < s.page_size(page); ++slot) entries.push_back(at(s.key_of(page, slot)));
      const auto body_at = [&](uint64_t place) {
        Bytes body;
        ZstdDecoder().decode(encode_page(entries, level.level == 0, place), {kMostText, kMostText}, "page", body);
        return body;
      };
      const auto [it, fresh] = pages_.try_emplace(body_at(0));
      if (fresh || own_pages) it->second = append(squeezed(body_at(out_.size()), page_ratio));
      places.push_back(it->second);
    }
  }
  Bytes hashed;
  const auto append_hashed = [&](const Bytes& frame) {
    hashed.insert(hashed.end(), frame.begin(), frame.end());
    return append(frame);
  };
  for (size_t i = 0; i < directories.size(); ++i) meta_.levels()[i].directory = append_hashed(encode_directory(directories[i])).offset;
  const std::string text = decode_text(encode_metadata(meta_), "metadata");
  Footer footer;
  const auto squeezed_text = [](const std::string& t) {
    return squeezed({t.begin(), t.end()}, t.size() <= kMostTextOfAnyFrame ? ~uint64_t{0} : 256);
  };
  footer.metadata = append_hashed(squeezed_text(text));
  footer.report = append_hashed(squeezed_text(report));
  XXH128_canonical_t hash;
  XXH128_canonicalFromHash(&hash, XXH3_128bits(hashed.data(), hashed.size()));
  std::copy(hash.digest, hash.digest + 16, footer.hash.begin());
  footer.file_bytes = out_.size() + kFooterBytes;
  append(encode_footer(footer));
  return out_;
}

}  // namespace teracell::testing
