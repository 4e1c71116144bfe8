#include "tools/export/zarr/zarr.hpp"

#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/base/error.hpp"
#include "store/base/in_order.hpp"
#include "store/text/json_text.hpp"
#include "tools/export/arrays/dense.hpp"
#include "tools/export/zarr/chunks.hpp"
#include "tools/export/zarr/files.hpp"
#include "tools/export/zarr/shard.hpp"

namespace teracell::exports {
namespace zarr {
namespace {

// Programs that know this comment find all documents at the beginning of the archive and of its directory (OME-Zarr's RFC 9).
constexpr char kZipComment[] = R"({"ome":{"version":"0.5","zipFile":{"centralDirectory":{"jsonFirst":true}}}})";

std::string key_of(const Index3& i) { return fmt::format("{}/{}/{}", i[2], i[1], i[0]); }

// Takes the frames of all columns in order.
class Writer {
 public:
  Writer(Files& files, bool sharded) : files_(files), sharded_(sharded) {}

  void take(const Column& column, const std::vector<Frame>& frames) {
    if (!sharded_) {
      for (const Frame& f : frames) files_.write(fmt::format("{}/{}", column.array->level, key_of(f.chunk)), f.bytes);
      return;
    }
    if (column.array != array_ || column.shard != shard_) {
      finish();
      array_ = column.array, shard_ = column.shard;
      index_ = ShardIndex(static_cast<size_t>(volume(array_->shard_chunks)));
    }
    const Index3 first = array_->chunks_of_shard(shard_).lo;
    for (const Frame& f : frames) {
      const Index3 within = {f.chunk[0] - first[0], f.chunk[1] - first[1], f.chunk[2] - first[2]};
      index_.put(static_cast<size_t>(in_c_order(within, array_->shard_chunks)), bytes_.size(), f.bytes.size());
      bytes_.insert(bytes_.end(), f.bytes.begin(), f.bytes.end());
    }
  }

  // Writes the shard, if anything but background was found.
  void finish() {
    if (bytes_.empty()) return;
    const Bytes index = index_.encode();
    bytes_.insert(bytes_.end(), index.begin(), index.end());
    files_.write(fmt::format("{}/c/{}", array_->level, key_of(shard_)), bytes_);
    bytes_.clear();
  }

 private:
  Files& files_;
  const bool sharded_;
  const Layout* array_ = nullptr;
  Index3 shard_{};
  ShardIndex index_{0};
  Bytes bytes_;  // of the shard
};

}  // namespace

void write_zarr(const Export& e, int version, const Pieces& pieces, int threads) {
  const bool sharded = version == 3;
  const size_t bytes = bytes_per_cell(e.most());
  const Hierarchy h{e, layouts_of(e, pieces.cells_of_chunk, pieces.chunks_of_shard / static_cast<int64_t>(bytes)), bytes,
                    e.map.empty() ? 0 : e.map[0]};
  e.progress(0);
  const std::unique_ptr<Files> files = files_at(e.output, sharded ? kZipComment : "");
  for (const auto& [name, document] : sharded ? documents3(h) : documents2(h)) {
    const std::string text = ascii_json(document);
    files->write(name, {reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  }
  double all = 0, done = 0;  // chunks
  for (const Layout& a : h.arrays) all += static_cast<double>(volume(a.chunks));
  std::vector<std::unique_ptr<ChunkMaker>> makers;
  for (int i = 0; i < threads; ++i) makers.push_back(chunk_maker(h));
  struct Made {
    Column column;
    std::vector<Frame> frames;
  };
  Columns columns(h, pieces.bytes_of_column);
  Writer writer(*files, sharded);
  in_order(
      threads, [&] { return columns.next(); },
      [&](const Column& column, int thread) {
        return Made{column, makers[static_cast<size_t>(thread)]->make(column)};
      },
      [&](const Made& made) {
        writer.take(made.column, made.frames);
        done += static_cast<double>(volume(size_of(made.column.chunks)));
        e.progress(done / all);
      });
  writer.finish();
  files->commit();
}

}  // namespace zarr

namespace {

void write_with_options(const Export& e) {
  const auto version = static_cast<int>(e.integer("--zarr-version", 2, 3, 3));
  const auto threads = static_cast<int>(e.integer("--threads", 1, 1024, std::max(1U, std::thread::hardware_concurrency())));
  if (version == 2 && e.output.extension() == ".ozx")
    throw UsageError("--zarr-version: a file .ozx has Zarr 3, found 2: take a name that ends in .zip");
  zarr::write_zarr(e, version, version == 3 ? zarr::kPieces3 : zarr::kPieces2, threads);
}

}  // namespace

ExportFormat zarr_format() {
  return {.name = "zarr",
          .extensions = {".zarr", ".zip", ".ozx"},
          .holds = "OME-Zarr: all levels from the chosen one up in a folder, or in a zip (.zip, .ozx)",
          .write = write_with_options,
          .options = {{"--zarr-version", "2|3", "Zarr 3 with many chunks in a file (default), or Zarr 2 with a file for each"},
                      {"--threads", "N", "how many threads, 1 to 1024 (default: one per core)"}},
          .coarser = true};
}

}  // namespace teracell::exports
