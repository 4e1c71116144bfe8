#include "mesher/run/read_scene.hpp"

#include <algorithm>
#include <thread>

#include "mesher/cad/idle_kernels.hpp"
#include "store/base/system/system.hpp"

namespace teracell::mesher {

int threads_of(const MeshOptions& options) {
  return options.threads > 0 ? options.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

Bodies read_scene(const Scene& scene, const MeshOptions& options, int threads, const Budget& budget, bool count, bool again,
                  const std::function<void(const char* phase, double share)>& progress) {
  CadOptions cad = options.cad;
  cad.threads = threads;
  if (cad.cache.empty() && !options.tmp.empty()) cad.cache = options.tmp / "teracell-cad";
  cad.waiting = [progress](double share) { progress("facets", share); };  // bodies keep it
  if (!cad.kernels) cad.kernels = std::make_shared<IdleKernels>();
  Bodies out = read_bodies(scene, plan_exact_surfaces(scene, cad, budget), options.count_aside ? std::max(2, threads) : threads, budget, count, again,
                           [&](double share) { progress("read", share); });
  cad.kernels->end();
  complete_flat_faces(scene, budget, out);
  system::give_back_memory(budget.unasked());
  return out;
}

}  // namespace teracell::mesher
