#include "mesher/formats/zip_package.hpp"

#include <strings.h>
#include <unzip.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <memory>
#include <utility>

#include <fmt/format.h>

#include "mesher/surface/facet.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

// Models are packed 5 to 30 times, thousands of copies a hundred times; what is made to fill a disk is packed a thousand times.
constexpr uint64_t kMostUnpacked = 250, kHarmless = uint64_t{1} << 26;
// Stands for a size that is told elsewhere, which Minizip 1.1 (Debian 12) does not find.
constexpr uint64_t kToldElsewhere = 0xffffffff;

}  // namespace

// What Minizip reads from.
struct ZipPackage::Source {
  const Contents* contents;
  uint64_t at = 0;
  std::exception_ptr failure;  // must not pass through Minizip

  static uLong read(void* self, void*, void* to, uLong bytes) {
    auto& s = *static_cast<Source*>(self);
    const size_t some = std::min<uint64_t>(bytes, s.contents->size() - std::min(s.at, s.contents->size()));
    try {
      s.contents->read(s.at, {static_cast<char*>(to), some});
    } catch (...) {
      s.failure = std::current_exception();
      return 0;
    }
    s.at += some;
    return some;
  }
  static long seek(void* self, void*, ZPOS64_T offset, int origin) {
    auto& s = *static_cast<Source*>(self);
    const uint64_t from = origin == SEEK_SET ? 0 : origin == SEEK_CUR ? s.at : s.contents->size();
    if (offset > s.contents->size() || from > s.contents->size() - offset) return -1;
    s.at = from + offset;
    return 0;
  }
  zlib_filefunc64_def functions() {
    zlib_filefunc64_def f{};
    f.opaque = this;
    f.zopen64_file = [](void* self, const void*, int) { return self; };
    f.zread_file = read;
    f.zwrite_file = [](void*, void*, const void*, uLong) -> uLong { return 0; };
    f.ztell64_file = [](void* self, void*) -> ZPOS64_T { return static_cast<Source*>(self)->at; };
    f.zseek64_file = seek;
    f.zclose_file = [](void*, void*) { return 0; };
    f.zerror_file = [](void* self, void*) { return static_cast<Source*>(self)->failure ? 1 : 0; };
    return f;
  }
  void rethrow() {
    if (failure) std::rethrow_exception(std::exchange(failure, nullptr));
  }
};

void ZipPackage::Close::operator()(void* package) const { unzClose(package); }

ZipPackage::ZipPackage(std::string name, const Contents& contents)
    : name_(std::move(name)), source_(std::make_unique<Source>(Source{.contents = &contents, .failure = {}})) {
  zlib_filefunc64_def functions = source_->functions();
  zip_.reset(unzOpen2_64("", &functions));
  source_->rethrow();
  if (!zip_) throw InputError(fmt::format("{}: not a sound ZIP package: its list of files is not at its end: is the file cut short?", name_));
}

ZipPackage::~ZipPackage() = default;

// (unzLocateFile() reads beyond names that are longer than its buffer.)
bool ZipPackage::has(const std::string& file) const {
  for (int status = unzGoToFirstFile(zip_.get()); status == UNZ_OK; status = unzGoToNextFile(zip_.get())) {
    std::array<char, 512> name{};
    if (unzGetCurrentFileInfo64(zip_.get(), nullptr, name.data(), name.size() - 1, nullptr, 0, nullptr, 0) != UNZ_OK) return false;
    if (strcasecmp(name.data(), file.c_str()) == 0) return true;
  }
  return false;
}

void ZipPackage::read(const std::string& file, const std::function<bool(std::string_view)>& take) const {
  const auto refuse = [&](const std::string& why) {
    source_->rethrow();
    throw InputError(fmt::format("{}: {} in the package: {}", name_, shown(file), why));
  };
  if (!has(file)) refuse("expected a file, found none");
  unz_file_info64 info{};
  if (unzGetCurrentFileInfo64(zip_.get(), &info, nullptr, 0, nullptr, 0, nullptr, 0) != UNZ_OK) refuse("its entry in the list of files is damaged");
  if (info.compressed_size == kToldElsewhere || info.uncompressed_size == kToldElsewhere)
    refuse("expected a model of less than 4 GB (2 GB by some programs), found a larger one: export it as STL, PLY or GLB, or in several files");
  if ((info.flag & 1) != 0) refuse("expected a file that is not encrypted");
  if (info.compression_method != 0 && info.compression_method != Z_DEFLATED)
    refuse(fmt::format("expected a file that is stored or deflated, found compression method {}", info.compression_method));
  if (unzOpenCurrentFile(zip_.get()) != UNZ_OK) refuse("it isn't where the list of files says: is the package damaged?");
  const uint64_t packed = std::min<uint64_t>(info.compressed_size, source_->contents->size());  // the list of files may say anything
  const auto close = [](void* package) { unzCloseCurrentFile(package); };
  std::unique_ptr<void, decltype(close)> opened(zip_.get(), close);
  std::array<char, 1 << 16> block;
  uint64_t unpacked = 0;
  for (;;) {
    const int got = unzReadCurrentFile(opened.get(), block.data(), block.size());
    if (got < 0) refuse("its compressed bytes are damaged");
    if (got == 0) break;
    unpacked += static_cast<uint64_t>(got);
    if (unpacked > kHarmless && unpacked / kMostUnpacked > packed)
      refuse(fmt::format("its {} bytes unpack to more than {} times as many: no model is packed so well, so nothing more is unpacked", packed,
                         kMostUnpacked));
    if (!take({block.data(), static_cast<size_t>(got)})) return;
  }
  if (unpacked != info.uncompressed_size) refuse(fmt::format("cut short: expected {} bytes, found {}", info.uncompressed_size, unpacked));
  if (unzCloseCurrentFile(opened.release()) == UNZ_CRCERROR) refuse("its bytes are not those that its checksum is of: is the package damaged?");
}

}  // namespace teracell::mesher
