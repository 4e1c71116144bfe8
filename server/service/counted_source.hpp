// The bytes of a grid that is served: what reads them is counted, and errors don't say where they lie.
#pragma once
#include <atomic>
#include <memory>

#include "store/base/file.hpp"

namespace teracell::server {

struct ReadCounters {
  std::atomic<uint64_t> reads{0}, bytes{0};  // of the files: chunks, index pages
  std::atomic<uint64_t> damaged{0};          // requests that failed on a damaged or unreadable file
};

// Its name has no folder and no host, since messages show it to clients. Threads may share it.
std::unique_ptr<ByteSource> counted_source(std::unique_ptr<ByteSource> source, std::shared_ptr<ReadCounters> counters);

}  // namespace teracell::server
