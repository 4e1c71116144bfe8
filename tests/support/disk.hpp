// A disk that fills up, and temporary files that can be got at.
#pragma once
#include <csignal>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <sys/resource.h>

#include "tests/support/meshed.hpp"

namespace teracell::testing {

// Files may not pass `limit` bytes while it lives: the nearest thing to a full disk that needs no disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t limit) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit now = before_;
    now.rlim_cur = limit;
    setrlimit(RLIMIT_FSIZE, &now);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;

 private:
  rlimit before_;
  void (*handler_)(int);
};

// The descriptor of the only file without a name in the folder.
inline int temporary_file(const TempFolder& folder) {
  for (int fd = 3; fd < 1024; ++fd) {
    std::error_code none;
    const std::string target = std::filesystem::read_symlink("/proc/self/fd/" + std::to_string(fd), none).string();
    if (target.starts_with(folder.path().string()) && target.ends_with("(deleted)")) return fd;
  }
  throw std::runtime_error("no temporary file is open");
}

}  // namespace teracell::testing
