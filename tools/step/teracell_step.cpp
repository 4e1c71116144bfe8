// teracell-step: reads a STEP file with OpenCASCADE for teracell, which talks to it through a socket. It is a program of its own so that a
// crash, a hang or gigabytes inside the CAD kernel cost one file and not the run.
//
// It reads the file that is open as descriptor 3 and writes lines of JSON: {"kernel": "OpenCASCADE 7.6.3"} at once, {"outline": ...} when it has read
// the file. Then it takes commands, one at a time:
//   box N, then N lines "SHAPE M0 .. M11"            answers {"box": [x0, y0, z0, x1, y1, z1]} around instances of shapes
//   facets DEFLECTION ANGLE THREADS PATH             writes PATH, says {"progress": share} and at last {"done": true}
// Lengths are in millimetres, angles in degrees. {"error": "..."} is the last line of a session that failed. It ends with its input.
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <iostream>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_Printer.hxx>
#include <mutex>
#include <new>
#include <nlohmann/json.hpp>
#include <sstream>
#include <Standard_Failure.hxx>
#include <Standard_Version.hxx>
#include <system_error>
#include <thread>

#include "tools/step/boxes.hpp"
#include "tools/step/facets.hpp"
#include "tools/step/model.hpp"

namespace teracell::step {
namespace {

using Json = nlohmann::json;

constexpr char kKernel[] = "OpenCASCADE " OCC_VERSION_COMPLETE;
constexpr int kIdleSeconds = 60;  // a session that nobody asks anything ends

// Lines of standard input, which a thread of its own always reads, so that teracell never waits to send: when there are no more, teracell is gone,
// and whatever the kernel is doing ends.
class Commands {
 public:
  Commands() {
    std::thread([this] {
      for (std::string line; std::getline(std::cin, line);) {
        std::lock_guard lock(mutex_);
        lines_.push_back(std::move(line));
        changed_.notify_one();
      }
      ::_exit(0);
    }).detach();
  }
  std::string next() {
    std::unique_lock lock(mutex_);
    if (!changed_.wait_for(lock, std::chrono::seconds(kIdleSeconds), [&] { return !lines_.empty(); })) ::_exit(0);
    std::string line = std::move(lines_.front());
    lines_.pop_front();
    return line;
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> lines_;
};

// The kernel writes what it likes to standard output, so answers go through a copy of it.
class Answers {
 public:
  Answers() : file_(::fdopen(::dup(1), "w")) {
    if (!file_ || !std::freopen("/dev/null", "w", stdout)) std::abort();
  }
  void say(const Json& answer) {
    const std::string line = answer.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
    std::fwrite(line.data(), 1, line.size(), file_);
    std::fflush(file_);
  }

 private:
  std::FILE* file_;
};

Json use_json(const Node::Use& use) { return {{"node", use.node}, {"matrix", use.matrix}, {"name", use.name}}; }

Json outline_json(const Model& model) {
  Json nodes = Json::array(), roots = Json::array(), shapes = Json::array();
  for (const Node& n : model.nodes) {
    Json uses = Json::array();
    for (const Node::Use& u : n.uses) uses.push_back(use_json(u));
    nodes.push_back({{"name", n.name}, {"product", n.product}, {"color", n.color}, {"material", n.material}, {"uses", uses}});
    nodes.back()["shape"] = n.shape ? Json(*n.shape) : Json();
  }
  for (const Node::Use& u : model.roots) roots.push_back(use_json(u));
  for (const Shape& s : model.shapes) shapes.push_back({{"faces", s.faces}, {"sender_volume", s.sender_volume ? Json(*s.sender_volume) : Json()}});
  return {{"nodes", nodes}, {"roots", roots}, {"shapes", shapes}};
}

std::vector<Instance> read_instances(std::istringstream& line, Commands& commands, size_t shapes) {
  size_t count = 0;
  if (!(line >> count) || count == 0) throw std::runtime_error("box: expected a number of instances");
  std::vector<Instance> out;
  for (size_t i = 0; i < count; ++i) {
    std::istringstream words(commands.next());
    Instance& instance = out.emplace_back();
    words >> instance.shape;
    for (double& m : instance.matrix) {
      std::string word;
      words >> word;
      m = std::strtod(word.c_str(), nullptr);
    }
    if (!words || instance.shape >= shapes) throw std::runtime_error("box: expected a shape and 12 numbers");
  }
  return out;
}

void obey(const std::string& command, Commands& commands, Answers& answers, const Model& model, Boxes& boxes) {
  std::istringstream line(command);
  std::string verb;
  line >> verb;
  if (verb == "box") {
    const Box box = boxes.around(read_instances(line, commands, model.shapes.size()));
    return answers.say({{"box", {box.lo[0], box.lo[1], box.lo[2], box.hi[0], box.hi[1], box.hi[2]}}});
  }
  std::string deflection, angle, path;
  Tolerances tolerances{};
  line >> deflection >> angle >> tolerances.threads;
  tolerances.deflection = std::strtod(deflection.c_str(), nullptr), tolerances.angle = std::strtod(angle.c_str(), nullptr);
  if (verb != "facets" || line.get() != ' ' || !std::getline(line, path) || !(tolerances.deflection > 0) || !(tolerances.angle > 0) ||
      tolerances.threads < 1)
    throw std::runtime_error("expected a command, found " + command);
  write_facets(model, tolerances, path, [&](double share) { answers.say({{"progress", share}}); });
  answers.say({{"done", true}});
}

void serve(Answers& answers) {
  Commands commands;
  answers.say({{"kernel", kKernel}});
  const Model model = read_model("/dev/fd/3");
  Boxes boxes(model);
  answers.say({{"outline", outline_json(model)}});
  for (;;) obey(commands.next(), commands, answers, model, boxes);
}

int run(Answers& answers) {
  std::string why;
  try {
    serve(answers);
  } catch (const std::bad_alloc&) {
    why = "out of memory";
  } catch (const std::system_error&) {
    why = "out of memory";  // a thread can't start
  } catch (const Standard_Failure& e) {
    const std::string words = e.GetMessageString() ? e.GetMessageString() : "";
    why = std::string("the CAD kernel gave up: ") + e.DynamicType()->Name() + (words.empty() ? "" : ": " + words);
  } catch (const std::exception& e) {
    why = e.what();
  }
  answers.say({{"error", why}});
  return 1;
}

void limit(int what, rlim_t most) {
  const rlimit both = {most, most};
  ::setrlimit(what, &both);
}

}  // namespace
}  // namespace teracell::step

int main(int count, char** words) {
  using namespace teracell::step;
  if (count != 3 || std::strcmp(words[1], "--memory") != 0) {
    std::fputs(
        "teracell-step reads STEP files for teracell with OpenCASCADE. It is not called by people: `teracell mesh part.step` and `teracell info part.step` call it.\n"
        "usage: teracell-step --memory BYTES\n",
        stderr);
    return 2;
  }
#ifdef __GLIBC__
  ::mallopt(M_ARENA_MAX, 4);  // each thread would have an arena, whose addresses count as memory
#endif
  limit(RLIMIT_CORE, 0);
  if (const auto memory = static_cast<rlim_t>(std::strtoull(words[2], nullptr, 10)); memory > 0) limit(RLIMIT_AS, memory);
  Message::DefaultMessenger()->RemovePrinters(STANDARD_TYPE(Message_Printer));
  Answers answers;
  const int status = run(answers);
  ::_exit(status);  // without destructors: the kernel's may fail after an exception, and the system takes all back
}
