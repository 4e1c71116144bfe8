#include "server/service/deflate.hpp"

#include <algorithm>
#include <new>

#include <fmt/format.h>
#include <zlib.h>

#include "store/base/error.hpp"

namespace teracell::server {
namespace {

void begin_deflate(z_stream& z, Wrapping wrapping) {
  if (deflateInit2(&z, 1, Z_DEFLATED, MAX_WBITS + (wrapping == Wrapping::kGzip ? 16 : 0), 8, Z_DEFAULT_STRATEGY) != Z_OK) throw std::bad_alloc();
}

class GzipParts final : public Parts {
 public:
  explicit GzipParts(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) { begin_deflate(z_, Wrapping::kGzip); }
  ~GzipParts() override { deflateEnd(&z_); }
  GzipParts(const GzipParts&) = delete;

  bool append(std::string& out) override {
    const size_t enough = out.size() + kEnough;
    bool more = true;
    while (more && out.size() < enough) {
      std::string plain;
      more = parts_->append(plain);
      put(plain, more ? Z_NO_FLUSH : Z_FINISH, out);
    }
    return more;
  }
  size_t memory() const override { return kState + parts_->memory(); }

 private:
  static constexpr size_t kState = size_t{1} << 18;  // bytes, with the default window and hash table of zlib

  void put(std::string& plain, int flush, std::string& out) {
    z_.next_in = reinterpret_cast<Bytef*>(plain.data());
    z_.avail_in = static_cast<uInt>(plain.size());
    do {
      const size_t before = out.size();
      out.resize(before + kEnough);
      z_.next_out = reinterpret_cast<Bytef*>(out.data() + before);
      z_.avail_out = kEnough;
      deflate(&z_, flush);
      out.erase(out.size() - z_.avail_out);  // not resize(): GCC 12 would warn of a string that grows by 2^64
    } while (z_.avail_out == 0);
  }

  std::unique_ptr<Parts> parts_;
  z_stream z_{};
};

}  // namespace

std::string deflated(std::string_view bytes, Wrapping wrapping) {
  z_stream z{};
  begin_deflate(z, wrapping);
  const std::unique_ptr<z_stream, int (*)(z_stream*)> end(&z, deflateEnd);
  std::string out(deflateBound(&z, bytes.size()), '\0');
  constexpr size_t kPiece = size_t{1} << 30;  // zlib counts its input and output in 32 bits
  size_t taken = 0, given = 0;
  int status = Z_OK;
  while (status == Z_OK) {
    const size_t in = std::min(kPiece, bytes.size() - taken), room = std::min(kPiece, out.size() - given);
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data() + taken));
    z.avail_in = static_cast<uInt>(in);
    z.next_out = reinterpret_cast<Bytef*>(out.data() + given);
    z.avail_out = static_cast<uInt>(room);
    status = deflate(&z, taken + in == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    taken += in - z.avail_in;
    given += room - z.avail_out;
  }
  if (status != Z_STREAM_END) throw Error(fmt::format("zlib could not compress {} bytes: status {}", bytes.size(), status));
  out.resize(given);
  out.shrink_to_fit();  // caches count the capacity
  return out;
}

std::unique_ptr<Parts> gzip_parts(std::unique_ptr<Parts> parts) { return std::make_unique<GzipParts>(std::move(parts)); }

}  // namespace teracell::server
