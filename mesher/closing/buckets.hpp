// Records in buckets, in memory while they fit and otherwise in a temporary file. It serves to bring records with equal
// hashes together when there are more of them than fit into memory.
#pragma once
#include <memory>
#include <type_traits>
#include <vector>

#include "store/base/spill.hpp"

namespace teracell::mesher {

// Not thread-safe.
template <class Record>
class Buckets {
  static_assert(std::is_trivially_copyable_v<Record>);

 public:
  // `memory` limits the bytes of records that wait in memory; `folder` is for the temporary file.
  Buckets(size_t buckets, uint64_t memory, std::filesystem::path folder) : buckets_(buckets), memory_(memory), folder_(std::move(folder)) {}

  size_t count() const { return buckets_.size(); }
  void add(size_t bucket, const Record& record) {
    buckets_[bucket].waiting.push_back(record);
    waiting_ += sizeof(Record);
    if (waiting_ > memory_) spill();
  }
  // The records of a bucket, in the order in which they were added.
  std::vector<Record> load(size_t bucket) const {
    const Bucket& from = buckets_[bucket];
    size_t stored = 0;
    for (const Extent& e : from.extents) stored += e.records;
    std::vector<Record> out(stored);
    Record* to = out.data();
    for (const Extent& e : from.extents) {
      file_->read(e.offset, {reinterpret_cast<uint8_t*>(to), e.records * sizeof(Record)});
      to += e.records;
    }
    out.insert(out.end(), from.waiting.begin(), from.waiting.end());
    return out;
  }

 private:
  struct Extent {
    uint64_t offset;
    size_t records;
  };
  struct Bucket {
    std::vector<Record> waiting;
    std::vector<Extent> extents;
  };
  void spill() {
    if (!file_) file_ = std::make_unique<SpillFile>(folder_, waiting_);
    for (Bucket& b : buckets_) {
      if (b.waiting.empty()) continue;
      file_->write(end_, {reinterpret_cast<const uint8_t*>(b.waiting.data()), b.waiting.size() * sizeof(Record)});
      b.extents.push_back({end_, b.waiting.size()});
      end_ += b.waiting.size() * sizeof(Record);
      b.waiting.clear();
    }
    waiting_ = 0;
  }

  std::vector<Bucket> buckets_;
  uint64_t memory_, waiting_ = 0, end_ = 0;
  std::filesystem::path folder_;
  std::unique_ptr<SpillFile> file_;
};

}  // namespace teracell::mesher
