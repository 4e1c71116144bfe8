#include "mesher/formats/zip_package.hpp"

#include <zip.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <exception>

#include <fmt/format.h>

#include "mesher/surface/reader.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

// libzip lists all files in memory, some hundred bytes each.
constexpr uint64_t kMostFiles = uint64_t{1} << 16;
// Models are packed 5 to 30 times; what is made to fill a disk is packed a thousand times.
constexpr uint64_t kMostTimes = 250, kHarmless = uint64_t{1} << 26;

struct Discard {
  void operator()(zip_file* file) const { zip_fclose(file); }
};

// The number of files that the end of the package states: at most the 65,535 that fit there, for of larger packages the list is read from
// elsewhere; those are refused.
uint64_t stated_files(const Contents& contents) {
  constexpr uint64_t kEnd = 22, kMostComment = 65535;
  std::string tail(std::min(contents.size(), kEnd + kMostComment), '\0');
  contents.read(contents.size() - tail.size(), tail);
  const size_t at = tail.rfind("PK\5\6");
  if (at == std::string::npos || at + kEnd > tail.size()) return 0;
  return static_cast<uint8_t>(tail[at + 10]) | static_cast<uint64_t>(static_cast<uint8_t>(tail[at + 11])) << 8;
}

}  // namespace

// What libzip reads from.
struct ZipPackage::Source {
  const Contents* contents;
  uint64_t at = 0;
  std::exception_ptr failure;  // must not pass through libzip
  zip_error_t error{};

  static zip_int64_t call(void* state, void* data, zip_uint64_t length, zip_source_cmd_t command) {
    auto& self = *static_cast<Source*>(state);
    switch (command) {
      case ZIP_SOURCE_OPEN: self.at = 0; return 0;
      case ZIP_SOURCE_READ: return self.read({static_cast<char*>(data), length});
      case ZIP_SOURCE_SEEK: {
        const zip_int64_t to = zip_source_seek_compute_offset(self.at, self.contents->size(), data, length, &self.error);
        if (to < 0) return -1;
        self.at = static_cast<uint64_t>(to);
        return 0;
      }
      case ZIP_SOURCE_TELL: return static_cast<zip_int64_t>(self.at);
      case ZIP_SOURCE_STAT: {
        auto* stat = ZIP_SOURCE_GET_ARGS(zip_stat_t, data, length, &self.error);
        if (!stat) return -1;
        zip_stat_init(stat);
        stat->size = self.contents->size();
        stat->valid = ZIP_STAT_SIZE;
        return sizeof *stat;
      }
      case ZIP_SOURCE_ERROR: return zip_error_to_data(&self.error, data, length);
      case ZIP_SOURCE_CLOSE:
      case ZIP_SOURCE_FREE: return 0;
      case ZIP_SOURCE_SUPPORTS:
        return zip_source_make_command_bitmap(ZIP_SOURCE_OPEN, ZIP_SOURCE_READ, ZIP_SOURCE_SEEK, ZIP_SOURCE_TELL, ZIP_SOURCE_STAT, ZIP_SOURCE_ERROR,
                                              ZIP_SOURCE_CLOSE, ZIP_SOURCE_FREE, -1);
      default: zip_error_set(&self.error, ZIP_ER_OPNOTSUPP, 0); return -1;
    }
  }

  zip_int64_t read(std::span<char> out) {
    const size_t some = std::min<uint64_t>(out.size(), contents->size() - std::min(at, contents->size()));
    try {
      contents->read(at, out.first(some));
    } catch (...) {
      failure = std::current_exception();
      zip_error_set(&error, ZIP_ER_READ, EIO);
      return -1;
    }
    at += some;
    return static_cast<zip_int64_t>(some);
  }
  void rethrow() {
    if (failure) std::rethrow_exception(std::exchange(failure, nullptr));
  }
};

void ZipPackage::Close::operator()(zip* package) const { zip_discard(package); }

ZipPackage::ZipPackage(std::string name, const Contents& contents)
    : name_(std::move(name)), source_(std::make_unique<Source>(Source{.contents = &contents, .failure = {}})) {
  if (stated_files(contents) == kMostFiles - 1)
    throw InputError(fmt::format("{}: expected a package of fewer than {} files, found more", name_, kMostFiles - 1));
  zip_error_t error;
  zip_error_init(&error);
  zip_source_t* source = zip_source_function_create(&Source::call, source_.get(), &error);
  if (!source) throw std::bad_alloc();
  zip_.reset(zip_open_from_source(source, ZIP_RDONLY, &error));
  if (zip_) return;
  const std::string why = zip_error_strerror(&error);
  zip_error_fini(&error);
  zip_source_free(source);
  source_->rethrow();
  throw InputError(fmt::format("{}: not a sound ZIP package: {}: is the file cut short?", name_, why));
}

ZipPackage::~ZipPackage() = default;

bool ZipPackage::has(const std::string& file) const { return zip_name_locate(zip_.get(), file.c_str(), ZIP_FL_NOCASE) >= 0; }

void ZipPackage::read(const std::string& file, const std::function<bool(std::string_view)>& take) const {
  const auto refuse = [&](const std::string& why) {
    source_->rethrow();
    throw InputError(fmt::format("{}: {} in the package: {}", name_, shown(file), why));
  };
  const zip_int64_t number = zip_name_locate(zip_.get(), file.c_str(), ZIP_FL_NOCASE);
  zip_stat_t stat;
  if (number < 0 || zip_stat_index(zip_.get(), static_cast<zip_uint64_t>(number), 0, &stat) != 0) refuse("expected a file, found none");
  if (stat.encryption_method != ZIP_EM_NONE) refuse("expected a file that is not encrypted");
  const std::unique_ptr<zip_file, Discard> opened(zip_fopen_index(zip_.get(), static_cast<zip_uint64_t>(number), 0));
  if (!opened) refuse(zip_strerror(zip_.get()));
  std::array<char, 1 << 16> block;
  for (uint64_t unpacked = 0;;) {
    const zip_int64_t got = zip_fread(opened.get(), block.data(), block.size());
    if (got < 0) refuse(zip_file_strerror(opened.get()));
    if (got == 0) return;
    unpacked += static_cast<uint64_t>(got);
    if (unpacked > kHarmless && unpacked / kMostTimes > stat.comp_size)
      refuse(fmt::format("its {} bytes unpack to more than {} times as many: no model is packed so well, so nothing more is unpacked", stat.comp_size,
                         kMostTimes));
    if (!take({block.data(), static_cast<size_t>(got)})) return;
  }
}

}  // namespace teracell::mesher
