#include "server/parts/column_parts.hpp"

#include <algorithm>
#include <optional>

#include "store/whole/info.hpp"

namespace teracell::server {
namespace {

constexpr int64_t kFewestRead = 4096, kMostRead = int64_t{1} << 18;  // cells that are read at once; each may be a run

class ColumnParts final : public Parts {
 public:
  ColumnParts(const GridReader& reader, int axis, int64_t a, int64_t b, int64_t from, int64_t to)
      : reader_(reader), json_(reader.meta(), axis, a, b), axis_(axis), a_(a), b_(b), at_(from), to_(to) {}

  bool append(std::string& out) override {
    const size_t enough = out.size() + kEnough;
    if (!begun_) json_.begin(out);
    begun_ = true;
    while (out.size() < enough && at_ < to_) read_runs(out, enough);
    if (at_ < to_) return true;
    json_.run(out, *last_);
    json_.end(out);
    return false;
  }
  size_t memory() const override { return sizeof *this; }

 private:
  // Runs that don't fit into the part are read again for the next one, so no more cells are asked for than twice the number that fitted
  // into the last one.
  void read_runs(std::string& out, size_t enough) {
    const int64_t from = at_;
    for (const ColumnRun& run : read_column(reader_, axis_, a_, b_, from, std::min(to_, from + cells_))) {
      if (out.size() >= enough) break;
      at_ = run.to;
      if (last_ && last_->material == run.material) {
        last_->to = run.to;
      } else {
        if (last_) json_.run(out, *last_);
        last_ = run;
      }
    }
    cells_ = std::clamp(2 * (at_ - from), kFewestRead, kMostRead);
  }

  const GridReader& reader_;
  ColumnJson json_;
  const int axis_;
  const int64_t a_, b_;
  int64_t at_;  // the next cell
  const int64_t to_;
  int64_t cells_ = kFewestRead;  // to be asked for at once
  bool begun_ = false;
  std::optional<ColumnRun> last_;  // may go on
};

}  // namespace

std::unique_ptr<Parts> column_parts(const GridReader& reader, int axis, int64_t a, int64_t b, int64_t from, int64_t to) {
  return std::make_unique<ColumnParts>(reader, axis, a, b, from, to);
}

}  // namespace teracell::server
