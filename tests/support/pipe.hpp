// A pipe that something writes into.
#pragma once
#include <poll.h>
#include <unistd.h>

#include "tests/support/test.hpp"

namespace teracell::testing {

struct Pipe {
  int out = -1, in = -1;
  Pipe() {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    out = ends[0], in = ends[1];
  }
  ~Pipe() {
    close(in);
    close_out();
  }
  void close_out() {
    if (out >= 0) close(std::exchange(out, -1));
  }
  // What comes until there are `lines` lines; without a number, what is there already.
  std::string rest(size_t lines = 0) const {
    std::string text;
    char bytes[4096];
    for (pollfd p{out, POLLIN, 0}; lines > 0 || poll(&p, 1, 0) > 0;) {
      const ssize_t n = read(out, bytes, sizeof bytes);
      if (n <= 0) break;
      text.append(bytes, static_cast<size_t>(n));
      const auto found = static_cast<size_t>(std::count(bytes, bytes + n, '\n'));
      if (lines > 0 && found >= lines) break;
      if (lines > 0) lines -= found;
    }
    return text;
  }
};

}  // namespace teracell::testing
