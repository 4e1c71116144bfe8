#include "mesher/cad/idle_kernels.hpp"

#include <algorithm>

namespace teracell::mesher {

std::unique_ptr<KernelProcess> IdleKernels::take(const std::string& file) {
  const std::lock_guard lock(mutex_);
  const auto found = std::ranges::find_if(list_, [&](const auto& idle) { return idle.first == file; });
  if (found == list_.end()) return nullptr;
  std::unique_ptr<KernelProcess> out = std::move(found->second);
  list_.erase(found);
  return out;
}

void IdleKernels::add(const std::string& file, std::unique_ptr<KernelProcess> kernel) {
  constexpr size_t kMost = 4;
  const std::lock_guard lock(mutex_);
  list_.emplace_front(file, std::move(kernel));
  if (list_.size() > kMost) list_.pop_back();
}

void IdleKernels::end() {
  const std::lock_guard lock(mutex_);
  list_.clear();
}

}  // namespace teracell::mesher
