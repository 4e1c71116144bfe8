// What every peer needs: its main function, a clock, a file's bytes.
#pragma once
#include <charconv>
#include <chrono>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace teracell::bench {

using Arguments = std::vector<std::string>;  // without the program's name

// Calls work(arguments) and returns the exit status. It is 2, with the usage on stderr, unless there are `least` to `most`
// arguments; it is 1, with the message of the exception, if the work fails.
template <class Work>
int peer_main(int argc, char** argv, const std::string& usage, size_t least, size_t most, Work&& work) {
  const std::string name = usage.substr(0, usage.find(' '));
  const Arguments arguments(argv + 1, argv + argc);
  if (arguments.size() < least || arguments.size() > most) {
    std::fprintf(stderr, "%s: expected %zu%s arguments, found %zu. Usage: %s\n", name.c_str(), least, most > least ? " or more" : "",
                 arguments.size(), usage.c_str());
    return 2;
  }
  try {
    work(arguments);
    return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: %s\n", name.c_str(), e.what());
    return 1;
  }
}

inline int64_t whole_number(const std::string& text) {
  int64_t n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc() || end != text.data() + text.size()) throw std::runtime_error("expected a whole number, found '" + text + "'");
  return n;
}

inline std::string bytes_of(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error("can't read " + path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace teracell::bench
