// Prints a partition: what holds for all parts, and then each part.
#include <cstdio>
#include <teracell.hpp>

int main(int, char** argv) try {
  const tc::Partition partition(argv[1]);
  const tc_plan plan = partition.plan();
  const auto numbers = [](const auto& all) {
    for (const int64_t n : all) std::printf("%lld ", static_cast<long long>(n));
  };
  numbers(std::array{plan.ranks, plan.cells[0], plan.cells[1], plan.cells[2], plan.align, plan.halo});
  std::printf("%.17g %s %s\n", plan.total, plan.method, plan.grid_hash);
  for (int64_t rank = 0; rank < plan.ranks; ++rank) {
    const tc::Part part = partition.part(rank);
    for (const tc::Index& corner : {part.box.lo, part.box.hi, part.halo_box.lo, part.halo_box.hi}) numbers(corner);
    std::printf("%.17g ", part.weight);
    numbers(part.neighbours);
    std::printf("\n");
  }
} catch (const tc::Error& e) {
  std::fprintf(stderr, "%d %d %s\n", e.status, e.error_number, e.what());
  return 1;
}
