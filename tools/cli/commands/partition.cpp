// teracell partition: boxes of equal work for the ranks of a parallel program.
#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/output_file.hpp"
#include "store/text/text.hpp"
#include "store/whole/partition.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/progress.hpp"
#include "tools/export/assignments.hpp"

namespace teracell::cli {
namespace {

struct PartitionArguments {
  GridArgument grid;
  std::string output, weight, method = "blocks", progress = "auto";
  int64_t ranks = 0, align = 1, halo = 0;
};

std::vector<double> weights_of(const std::string& text, const GridReader& reader) {
  const std::vector<MaterialInfo>& materials = reader.meta().materials;
  std::vector<double> weights(materials.size(), 1);
  if (text.empty()) return weights;
  const auto take = [&](size_t id, const std::string& name, const std::string& value) {
    weights[id] = exports::parse_number(value, "--weight: " + name);
  };
  const std::vector<bool> named = exports::for_each_assignment(materials, text, "--weight", take);
  exports::expect_named(reader, 0, reader.meta().grid.box(0), named, "--weight");
  return weights;
}

void run(const PartitionArguments& o) {
  check_output({o.grid.name}, o.output);
  const GridReader reader = open_grid(o.grid);
  PartitionOptions options{o.ranks, o.method == "slabs" ? PartitionMethod::kSlabs : PartitionMethod::kBlocks, weights_of(o.weight, reader), o.align,
                           o.halo};
  const Wanted wanted = until_interrupted(o.output);
  OutputFile file(o.output);
  Partition p;
  {
    ProgressLine line(o.progress, "partition");
    p = make_partition(reader, options, [&](double share) { line("cut", share); });
  }
  const std::string text = partition_json(p) + "\n";
  file.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  file.commit();
  double heaviest = 0;
  size_t neighbours = 0;
  for (const Part& part : p.parts) heaviest = std::max(heaviest, part.weight), neighbours = std::max(neighbours, part.neighbours.size());
  const double mean = p.total / static_cast<double>(o.ranks);
  say(fmt::format("{}: {}, {}; the heaviest has {:.3f} of the mean; at most {} neighbours", o.output, counted(static_cast<uint64_t>(o.ranks), "rank"),
                  o.method, mean > 0 ? heaviest / mean : 1, neighbours));
}

}  // namespace

Run setup_partition(CLI::App& app) {
  const auto o = std::make_shared<PartitionArguments>();
  add_grid(app, o->grid);
  app.add_option("--ranks", o->ranks, "how many boxes")->required();
  app.add_option("-o,--output", o->output, "the JSON file to write")->required();
  app.add_option("--weight", o->weight, "NAME=WORK,...: the work of a cell of each material (default: 1 for all)");
  app.add_option("--method", o->method, "blocks: compact boxes; slabs: cut along the longest axis alone (default blocks)")
      ->check(one_of({"blocks", "slabs"}));
  app.add_option("--align", o->align, "cuts lie at multiples of so many cells (default 1)");
  app.add_option("--halo", o->halo, "cells around each box that its rank reads, too (default 0)");
  add_progress(app, o->progress);
  app.footer("Example:\n  teracell partition g.tcell --ranks 512 --weight air=1,steel=0 --halo 1 -o parts.json");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
