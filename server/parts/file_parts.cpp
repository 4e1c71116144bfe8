#include "server/parts/file_parts.hpp"

#include <algorithm>

namespace teracell::server {
namespace {

class FileParts final : public Parts {
 public:
  explicit FileParts(const ByteSource& file) : file_(file) {}

  bool append(std::string& out) override {
    const auto size = static_cast<size_t>(std::min<uint64_t>(kRead, file_.size() - at_));
    out.resize(out.size() + size);
    file_.read(at_, {reinterpret_cast<uint8_t*>(out.data() + out.size() - size), size});
    at_ += size;
    return at_ < file_.size();
  }
  size_t memory() const override { return sizeof *this; }

 private:
  static constexpr uint64_t kRead = uint64_t{1} << 20;
  const ByteSource& file_;
  uint64_t at_ = 0;
};

}  // namespace

std::unique_ptr<Parts> file_parts(const ByteSource& file) { return std::make_unique<FileParts>(file); }

}  // namespace teracell::server
