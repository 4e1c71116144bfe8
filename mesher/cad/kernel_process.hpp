// teracell-step at work on one file: a program of its own, because a CAD kernel may crash, hang or take all memory on one bad file. It is asked
// by lines of text and answers by lines of JSON (tools/step/teracell_step.cpp says which).
#pragma once
#include <sys/types.h>

#include <chrono>
#include <string>

#include "mesher/surface/read_options.hpp"
#include "store/base/descriptor.hpp"

namespace teracell::mesher {

// teracell-step beside this program, else on the PATH. Throws InputError, which begins with `name`, where there is none.
std::filesystem::path kernel_program(const std::string& name);

// Not to be shared by threads. Destroyed, it ends the program, whatever that is doing.
class KernelProcess {
 public:
  // Begins to read the file that is open as `file`. `name` stands for it in messages.
  KernelProcess(const std::filesystem::path& program, std::string name, const Descriptor& file, const CadOptions& options);
  ~KernelProcess();
  KernelProcess(const KernelProcess&) = delete;

  // Sends a command, if it isn't empty, and returns the answer, which has this key. Answers that tell progress are passed to options.waiting, which
  // may throw. Throws InputError when the kernel fails, dies, or exceeds its limits.
  std::string ask(const std::string& command, const std::string& key, const CadOptions& options);
  // It lives, and is not at work on what somebody has stopped to wait for.
  bool is_idle();

 private:
  void send(const std::string& text);
  bool next_line(std::string& line, const CadOptions& options, double share);
  [[noreturn]] void fail_after_end(const CadOptions& options);
  const std::string name_;
  pid_t process_ = -1;
  Descriptor socket_;
  std::string buffer_;
  size_t searched_ = 0;  // bytes of it without the end of a line
  bool busy_ = false;
  std::chrono::steady_clock::time_point began_;  // to work on what is asked
};

}  // namespace teracell::mesher
