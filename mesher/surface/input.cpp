#include "mesher/surface/input.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <new>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::mesher {

void Input::Release::operator()(XXH3_state_s* state) const { XXH3_freeState(state); }

void Input::Release::operator()(z_stream_s* stream) const {
  inflateEnd(stream);
  delete stream;
}

Input::Input(const std::filesystem::path& path) : name_(path.string()) {
  descriptor_ = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (const int error = errno; descriptor_ < 0) throw IoError(fmt::format("{}: can't be opened: {}", name_, std::strerror(error)), error);
  try {
    struct stat status {};
    regular_ = fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
    if (regular_) size_ = status.st_size;
    if (S_ISDIR(status.st_mode)) throw IoError(fmt::format("{}: expected a surface file, found a folder", name_), EISDIR);
    if (!size_ || *size_ > kWindow) posix_fadvise(descriptor_, 0, 0, POSIX_FADV_SEQUENTIAL);  // a hint: a failure only costs speed
    begin();
  } catch (...) {
    close(descriptor_);
    throw;
  }
}

Input::Input(std::string name, std::string_view bytes) : name_(std::move(name)), memory_(bytes), whole_memory_(bytes), size_(bytes.size()) {
  begin();
}

Input::~Input() {
  if (descriptor_ >= 0) close(descriptor_);
}

// The first bytes tell whether the file is compressed.
void Input::begin() {
  hash_.reset(XXH3_createState());
  if (!hash_) throw std::bad_alloc();
  XXH3_128bits_reset(hash_.get());
  buffer_.resize(size_ ? std::clamp<size_t>(*size_ + 1, 256, kWindow) : kWindow);  // most files of an assembly are small
  fill(3);
  if (window(0).substr(0, 3) != "\x1f\x8b\x08") return;

  compressed_.swap(buffer_);
  buffer_.resize(kWindow);
  auto stream = std::make_unique<z_stream>();
  *stream = {};
  stream->next_in = reinterpret_cast<Bytef*>(compressed_.data());
  stream->avail_in = static_cast<uInt>(end_);
  if (inflateInit2(stream.get(), MAX_WBITS + 16) != Z_OK) throw std::bad_alloc();
  inflate_.reset(stream.release());
  begin_ = end_ = 0;
  size_.reset();
}

void Input::fill(size_t want) {
  std::memmove(buffer_.data(), buffer_.data() + begin_, end_ - begin_);
  offset_ += begin_;
  end_ -= begin_;
  begin_ = 0;
  while (end_ < want) {
    if (end_ == buffer_.size()) buffer_.resize(std::min(2 * end_, kWindow));  // files that the system makes up have size 0
    char* to = buffer_.data() + end_;
    const size_t room = buffer_.size() - end_;
    const size_t got = inflate_ ? read_inflated(to, room) : read_disk(to, room);
    if (got == 0) return;
    end_ += got;
  }
}

void Input::take(std::span<char> out, size_t& got) {
  got = std::min(out.size(), end_ - begin_);
  std::memcpy(out.data(), buffer_.data() + begin_, got);
  begin_ += got;
  if (got == out.size()) return;
  offset_ += begin_;
  begin_ = end_ = 0;
  while (got < out.size()) {
    char* const to = out.data() + got;
    const size_t room = out.size() - got, more = inflate_ ? read_inflated(to, room) : read_disk(to, room);
    if (more == 0) break;
    got += more, offset_ += more;
  }
}

size_t Input::read_disk(char* to, size_t room) {
  size_t got;
  if (descriptor_ < 0) {
    got = memory_.copy(to, room);
    memory_.remove_prefix(got);
  } else if (disk_bytes_ > 0 && disk_bytes_ == size_) {
    got = 0;  // known without asking: of a small file that would be every second call of the system
  } else {
    ssize_t n;
    do n = read(descriptor_, to, room);
    while (n < 0 && errno == EINTR);
    if (n < 0) throw IoError(fmt::format("{}: byte {}: can't be read: {}", name_, disk_bytes_, std::strerror(errno)));
    got = static_cast<size_t>(n);
  }
  XXH3_128bits_update(hash_.get(), to, got);
  disk_bytes_ += got;
  return got;
}

size_t Input::read_inflated(char* to, size_t room) {
  z_stream& z = *inflate_;
  z.next_out = reinterpret_cast<Bytef*>(to);
  z.avail_out = static_cast<uInt>(room);
  while (z.avail_out == room) {
    if (!more_compressed()) {
      if (inside_member_) damaged("cut short: it ends inside the compressed data");
      return 0;
    }
    if (!inside_member_) {  // after a member comes another one, or zeros up to the end, with which tapes pad
      if (*z.next_in == 0) {
        ++z.next_in, --z.avail_in;
        if (more_compressed() && *z.next_in != 0) damaged("stray bytes after the compressed data");
        continue;
      }
      inflateReset(&z);
      inside_member_ = true;
    }
    switch (inflate(&z, Z_NO_FLUSH)) {
      case Z_OK:
      case Z_BUF_ERROR: break;
      case Z_STREAM_END: inside_member_ = false; break;
      case Z_MEM_ERROR: throw std::bad_alloc();
      default: damaged(z.msg ? z.msg : "not gzip data");
    }
  }
  return room - z.avail_out;
}

bool Input::more_compressed() {
  if (inflate_->avail_in > 0) return true;
  const size_t got = read_disk(compressed_.data(), compressed_.size());
  inflate_->next_in = reinterpret_cast<Bytef*>(compressed_.data());
  inflate_->avail_in = static_cast<uInt>(got);
  return got > 0;
}

void Input::damaged(const char* what) const {
  throw InputError(fmt::format("{}: byte {} of the compressed file: damaged gzip: {}", name_, disk_bytes_ - inflate_->avail_in, what));
}

bool Input::next_line(std::string_view& line) {
  for (size_t scanned = 0;;) {
    const std::string_view rest = window(0);
    const size_t stop = rest.find(newline_, scanned);
    if (stop != std::string_view::npos) {
      line = rest.substr(0, stop);
      consume(stop + 1);
      break;
    }
    scanned = rest.size();
    if (scanned == buffer_.size()) {
      if (scanned >= kLongestLine)
        throw InputError(fmt::format("{}: line {}: the line is longer than {} bytes: is this a text file?", name_, line_ + 1, kLongestLine));
      buffer_.resize(2 * scanned);
    }
    if (window(scanned + 1).size() == scanned) {  // the contents end without a newline
      if (scanned == 0) return false;
      line = window(0);
      consume(scanned);
      break;
    }
  }
  ++line_;
  if (line.ends_with('\r')) line.remove_suffix(1);
  return true;
}

Descriptor Input::plain_file() const {
  if (descriptor_ < 0 || !regular_ || inflate_) return Descriptor();
  Descriptor copy(fcntl(descriptor_, F_DUPFD_CLOEXEC, 0));
  if (const int error = errno; !copy) throw IoError(fmt::format("{}: can't be opened once more: {}", name_, std::strerror(error)), error);
  return copy;
}

std::optional<std::string_view> Input::plain_memory() const { return descriptor_ >= 0 || inflate_ ? std::nullopt : std::optional(whole_memory_); }

std::string Input::at_line() const { return fmt::format("{}: line {}", name_, line_); }

std::string Input::at_byte(uint64_t offset) const { return fmt::format("{}: byte {}{}", name_, offset, inflate_ ? " (uncompressed)" : ""); }

std::string Input::hash() const {
  XXH128_canonical_t canonical;
  XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(hash_.get()));
  std::string hex;
  hex.reserve(32);
  for (const unsigned char byte : canonical.digest)
    for (const int digit : {byte >> 4, byte & 15}) hex += "0123456789abcdef"[digit];
  return hex;
}

}  // namespace teracell::mesher
