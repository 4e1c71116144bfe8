// The grid's file as it is.
#include "server/answers/answers.hpp"

#include <algorithm>

namespace teracell::server {
namespace {

// The file as it is, read as it is taken.
class FileParts final : public Parts {
 public:
  // REQUIRES: `file` outlives it.
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

Response answer_file(const GridRequest& r) {
  r.target.allow({"v"});
  return r.answer(
      {.route = "file", .content_type = "application/octet-stream", .parts = [&] { return std::make_unique<FileParts>(r.reader().source()); }});
}

}  // namespace

const Answer kFileAnswer = {"file.tcell", 1, Cost::kDear, answer_file};

}  // namespace teracell::server
