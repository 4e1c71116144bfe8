#include "mesher/run/casting.hpp"

#include <algorithm>
#include <mutex>
#include <utility>

#include "store/base/in_order.hpp"

namespace teracell::mesher {

CastTotals no_totals(const Scene& scene) {
  CastTotals out;
  out.cells.resize(scene.bodies.size());
  out.covered.resize(scene.bodies.size());
  return out;
}

void add_totals(CastTotals& sum, const TileGroupWork& group) {
  for (const RowTotals& row : group.totals()) sum.add(row);
  group.add_amounts(sum.sums);
}

Casting::Casting(const PreparedRun& run, const EngineMaker& make_engine) : run_(run) {
  for (uint32_t b = 0; b < run.scene.bodies.size(); ++b) layers_.insert(layers_.end(), {{b, false}, {b, true}});
  const bool exact = std::ranges::any_of(run.bodies.bodies, [](const BodyFacets& b) { return b.file.cad != nullptr; });
  for (int i = 0; i < run.threads; ++i) {
    workers_.push_back(std::make_unique<Worker>(make_engine(), layers_, run.plan.labels, run.scene, run.plan.meta, run.options));
    workers_.back()->sums_shares = exact;
  }
}

void Casting::cast(Tiling& tiling, const std::function<std::optional<TileGroup>()>& next_group, PyramidWriter& pyramid,
                   const std::function<void(const TileGroupWork&)>& stored) {
  struct Job {
    std::shared_ptr<TileGroupWork> work;  // null: a bin was passed by
    uint32_t row;
  };
  Job next{nullptr, TileGroupWork::kRows};
  // Groups that are stored. To free them takes time, so a thread that casts does it.
  std::vector<std::shared_ptr<TileGroupWork>> to_free;
  std::mutex of_stored;
  in_order(
      run_.threads,
      [&]() -> std::optional<Job> {
        if (next.row == TileGroupWork::kRows) {
          auto group = next_group();
          if (!group) return std::nullopt;
          if (group->passed) return Job{nullptr, 0};
          auto above = pyramid.node_above(2, group->cu, group->cv);
          next = {std::make_shared<TileGroupWork>(std::move(*group), tiling, run_.plan.meta, std::move(above)), 0};
        }
        return Job{next.work, next.row++};
      },
      [&](Job job, int worker) {
        if (!job.work) return job;
        std::unique_lock lock(of_stored);
        auto freed = std::exchange(to_free, {});
        lock.unlock();
        freed.clear();
        job.work->make_row(job.row, *workers_[worker]);
        return job;
      },
      [&](Job job) {
        if (!job.work || job.row + 1 < TileGroupWork::kRows) return;  // rows come in order, so with the last one all are made
        for (const LevelChunk& chunk : job.work->chunks()) pyramid.put(chunk);
        job.work->for_each_frame([&](size_t channel, const ChunkKey& key, const Bytes& frame) { pyramid.sink().put_cells(channel, key, frame); });
        pyramid.put_above(job.work->above(), job.work->group().cu, job.work->group().cv);
        stored(*job.work);
        std::lock_guard lock(of_stored);
        to_free.push_back(std::move(job.work));
      },
      size_t{2} * TileGroupWork::kRows, run_.bodies.helper.get(), [&] { return tiling.next_load(); });
}

}  // namespace teracell::mesher
