#include "mesher/cad/kernel_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "mesher/surface/facet.hpp"
#include "store/base/error.hpp"
#include "store/base/system/system.hpp"
#include "store/text/json_text.hpp"
#include "store/text/text.hpp"
#include "store/text/words.hpp"

namespace teracell::mesher {
namespace {

constexpr char kProgram[] = "teracell-step";
constexpr int kFileInProgram = 3;

std::string size_text(uint64_t bytes) { return fmt::format("{} MiB", bytes >> 20); }

// `end` becomes standard input and output of the program.
pid_t spawn(const std::filesystem::path& program, const std::string& name, const std::string& memory, const Descriptor& end, const Descriptor& file) {
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  // A group of its own: the terminal's interrupt is for this program, which ends the other one.
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  ::posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
  for (const int place : {0, 1}) ::posix_spawn_file_actions_adddup2(&actions, end.get(), place);
  ::posix_spawn_file_actions_adddup2(&actions, file.get(), kFileInProgram);
  char* const list[] = {const_cast<char*>(kProgram), const_cast<char*>("--memory"), const_cast<char*>(memory.c_str()), nullptr};
  pid_t process = -1;
  const int error = ::posix_spawn(&process, program.c_str(), &actions, &attributes, list, environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  if (error != 0) throw IoError(fmt::format("{}: can't start {}: {}", name, program.string(), std::strerror(error)), error);
  return process;
}

std::pair<Descriptor, Descriptor> connected_pair() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw IoError(fmt::format("can't make a socket: {}", std::strerror(errno)), errno);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

int wait_for(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

std::filesystem::path kernel_program(const std::string& name) {
  std::error_code error;
  const std::filesystem::path self = system::own_program();
  std::vector<std::filesystem::path> folders;
  if (!self.empty()) folders.push_back(self.parent_path());
  const char* const path = std::getenv("PATH");
  for (std::string_view rest = path ? path : ""; !rest.empty();) {
    const size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0) folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  for (const std::filesystem::path& folder : folders)
    if (::access((folder / kProgram).c_str(), X_OK) == 0 && std::filesystem::is_regular_file(folder / kProgram, error)) return folder / kProgram;
  throw InputError(
      fmt::format("{}: STEP files are read by {}, a program of its own; found none beside this program or on the PATH: "
                  "install the Debian package teracell-step, or build it with -DTERACELL_STEP=ON",
                  name, kProgram));
}

// The lower descriptors that become 0, 1 and 3 must not be those of the pair, so the pair is moved out of the way.
KernelProcess::KernelProcess(const std::filesystem::path& program, std::string name, const Descriptor& file, const CadOptions& options)
    : name_(std::move(name)), began_(std::chrono::steady_clock::now()) {
  auto [here, there] = connected_pair();
  const Descriptor their_end(::fcntl(there.get(), F_DUPFD_CLOEXEC, 10)), their_file(::fcntl(file.get(), F_DUPFD_CLOEXEC, 10));
  if (!their_end || !their_file) throw IoError(fmt::format("{}: can't open: {}", name_, std::strerror(errno)), errno);
  process_ = spawn(program, name_, fmt::format("{}", options.memory), their_end, their_file);
  socket_ = std::move(here);
}

KernelProcess::~KernelProcess() {
  if (process_ <= 0) return;
  ::kill(process_, SIGKILL);
  wait_for(process_);
}

bool KernelProcess::is_idle() {
  if (process_ > 0 && ::waitpid(process_, nullptr, WNOHANG) != 0) process_ = -1;
  return process_ > 0 && !busy_;
}

void KernelProcess::send(const std::string& text) {
  for (size_t done = 0; done < text.size();) {
    const ssize_t sent = ::send(socket_.get(), text.data() + done, text.size() - done, MSG_NOSIGNAL);
    if (sent < 0 && errno == EINTR) continue;
    if (sent < 0) return;  // it is gone, which next_line() will find
    done += static_cast<size_t>(sent);
  }
}

bool KernelProcess::next_line(std::string& line, const CadOptions& options, double share) {
  for (;;) {
    if (const size_t end = buffer_.find('\n', searched_); end != std::string::npos) {
      line = buffer_.substr(0, end);
      buffer_.erase(0, end + 1);
      searched_ = 0;
      return true;
    }
    searched_ = buffer_.size();
    options.waiting(share);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    if (seconds > options.seconds)
      throw InputError(
          fmt::format("{}: the CAD kernel was stopped after {:.3g} seconds: expected it to be done within {:.3g}", name_, seconds, options.seconds),
          Remedy::kCadTime);
    pollfd waits = {socket_.get(), POLLIN, 0};
    constexpr int kLook = 100;  // milliseconds between two looks at whether the user has asked to stop
    if (::poll(&waits, 1, kLook) <= 0) continue;
    char some[1 << 16];
    const ssize_t got = ::recv(socket_.get(), some, sizeof some, 0);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    buffer_.append(some, static_cast<size_t>(got));
    if (buffer_.size() > size_t{1} << 30) throw InputError(fmt::format("{}: the CAD kernel's answer is longer than a gigabyte", name_));
  }
}

void KernelProcess::fail_after_end(const CadOptions& options) {
  ::kill(process_, SIGKILL);  // has no effect on one that has ended
  const int status = wait_for(std::exchange(process_, -1));
  const std::string how = WIFSIGNALED(status) ? fmt::format("it was ended by signal {} ({})", WTERMSIG(status), ::strsignal(WTERMSIG(status)))
                                              : fmt::format("it ended with status {}", WEXITSTATUS(status));
  // These may be for want of memory: OpenCASCADE 7.8 uses what it did not get.
  const bool memory = WIFSIGNALED(status) && (WTERMSIG(status) == SIGABRT || WTERMSIG(status) == SIGKILL || WTERMSIG(status) == SIGSEGV);
  throw InputError(fmt::format("{}: the CAD kernel failed on this file: {}{}", name_, how,
                               memory ? fmt::format("; it may have {} of memory", size_text(options.memory)) : ""),
                   memory ? Remedy::kCadMemory : Remedy::kNone);
}

std::string KernelProcess::ask(const std::string& command, const std::string& key, const CadOptions& options) {
  if (!command.empty()) began_ = std::chrono::steady_clock::now();
  busy_ = true;
  send(command);
  double share = 0;
  for (std::string line; next_line(line, options, share);) {
    if (line.starts_with(fmt::format("{{\"{}\":", key))) {  // it may be long, and whoever asks parses it
      busy_ = false;
      return line;
    }
    Json answer;
    try {
      answer = Json::parse(line);
    } catch (const Json::exception&) {
      throw InputError(fmt::format("{}: expected an answer of {}, found {}", name_, kProgram, shown(line)));
    }
    if (const auto progress = answer.find("progress"); progress != answer.end() && progress->is_number()) share = progress->get<double>();
    if (const auto error = answer.find("error"); error != answer.end() && error->is_string()) {
      const bool memory = *error == "out of memory";
      if (error->get<std::string>().starts_with("can't write"))
        throw IoError(fmt::format("{}: {}", name_, printable(error->get<std::string>())), Remedy::kOtherFolder);
      throw InputError(memory ? fmt::format("{}: the CAD kernel needs more than the {} of memory that it may have", name_, size_text(options.memory))
                              : fmt::format("{}: {}", name_, printable(error->get<std::string>())),
                       memory ? Remedy::kCadMemory : Remedy::kNone);
    }
  }
  fail_after_end(options);
}

}  // namespace teracell::mesher
