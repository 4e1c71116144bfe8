#include "server/service/counted_source.hpp"

namespace teracell::server {
namespace {

class CountedSource final : public ByteSource {
 public:
  CountedSource(std::unique_ptr<ByteSource> source, std::shared_ptr<ReadCounters> counters)
      : source_(std::move(source)), name_(source_->name().substr(source_->name().rfind('/') + 1)), counters_(std::move(counters)) {}
  uint64_t size() const override { return source_->size(); }
  const std::string& name() const override { return name_; }
  void read(uint64_t offset, std::span<uint8_t> out) const override {
    counters_->reads.fetch_add(1, std::memory_order_relaxed);
    counters_->bytes.fetch_add(out.size(), std::memory_order_relaxed);
    without_folder([&] { source_->read(offset, out); });
  }
  bool is_far() const override { return source_->is_far(); }
  void prefetch(std::span<const ByteRange> soon) const override {
    without_folder([&] { source_->prefetch(soon); });
  }
  bool was_replaced() const override { return source_->was_replaced(); }

 private:
  template <class F>
  void without_folder(F&& f) const try {
    f();
  } catch (const Replaced& e) {
    throw Replaced(without_folder_of(e.what()));
  } catch (const IoError& e) {
    throw IoError(without_folder_of(e.what()));
  }
  std::string without_folder_of(std::string message) const {
    if (message.starts_with(source_->name())) message.replace(0, source_->name().size(), name_);
    return message;
  }
  const std::unique_ptr<ByteSource> source_;
  const std::string name_;
  const std::shared_ptr<ReadCounters> counters_;
};

}  // namespace

std::unique_ptr<ByteSource> counted_source(std::unique_ptr<ByteSource> source, std::shared_ptr<ReadCounters> counters) {
  return std::make_unique<CountedSource>(std::move(source), std::move(counters));
}

}  // namespace teracell::server
