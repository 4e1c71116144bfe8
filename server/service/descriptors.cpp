#include "server/service/descriptors.hpp"

#include <sys/resource.h>

#include <algorithm>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::server {
namespace {

constexpr uint64_t kFewFiles = 64;     // even if fewer are served at the start: others may be added
constexpr uint64_t kManyFiles = 4096;  // further ones are closed and opened again
constexpr uint64_t kLeast = 8;         // connections, and files, without which a server is of no use
constexpr uint64_t kPerThread = 4;     // epoll, event and timer of an io thread; a file that a thread of the pool reads
constexpr uint64_t kSpare = 48;        // the port, signals, a folder that is listed, files of the page, connections that are refused or too many

}  // namespace

DescriptorShares wanted_descriptors(uint64_t connections, uint64_t grids, uint64_t threads, uint64_t open) {
  return {connections, std::clamp(grids, kFewFiles, kManyFiles), open + kPerThread * threads + kSpare};
}

DescriptorShares allowed_descriptors(const DescriptorShares& wanted, uint64_t allowed) {
  const uint64_t least = wanted.others + std::min(wanted.connections, kLeast) + kLeast;
  if (allowed < least)
    throw IoError(
        fmt::format("expected a limit of at least {0} descriptors ({1} for all connections and grids), found {2}: raise it with "
                    "'ulimit -n {1}' in a shell, or with LimitNOFILE={1} in a systemd unit",
                    least, wanted.all(), allowed));
  const uint64_t rest = allowed - wanted.others;
  const uint64_t left = rest - std::min(rest, wanted.connections);  // for files, if connections had all they want
  const uint64_t files = std::min(wanted.files, std::max({left, rest / 4, kLeast}));
  return {std::min(wanted.connections, rest - files), files, wanted.others};
}

DescriptorShares share_descriptors(const DescriptorShares& wanted) {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return wanted;
  const rlimit raised{std::min<rlim_t>(limit.rlim_max, wanted.all()), limit.rlim_max};
  if (limit.rlim_cur < raised.rlim_cur && setrlimit(RLIMIT_NOFILE, &raised) == 0) limit = raised;
  return allowed_descriptors(wanted, limit.rlim_cur);
}

}  // namespace teracell::server
