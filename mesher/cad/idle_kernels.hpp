// Kernels that have read a file and wait for more questions: a run looks at a file's tree first, then at its box, then at its facets, from different
// places. It owns them, by way of CadOptions, and ends them when it has all facets.
#pragma once
#include <list>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "mesher/cad/kernel_process.hpp"

namespace teracell::mesher {

// Threads may share it.
class IdleKernels {
 public:
  // The one that has read the file with this hash; null: there is none.
  std::unique_ptr<KernelProcess> take(const std::string& file);
  // Those that have waited for longest end when there are too many.
  void add(const std::string& file, std::unique_ptr<KernelProcess> kernel);
  // Ends all, which gives back their memory.
  void end();

 private:
  std::mutex mutex_;
  std::list<std::pair<std::string, std::unique_ptr<KernelProcess>>> list_;
};

}  // namespace teracell::mesher
