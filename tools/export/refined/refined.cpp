#include "tools/export/refined/refined.hpp"

#include <thread>

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace teracell::exports {
namespace {

std::string value_of(const Export& e, const char* option, const std::string& otherwise) {
  const auto it = e.options.find(option);
  return it == e.options.end() ? otherwise : it->second;
}

}  // namespace

std::vector<ExportOption> refined_options(std::vector<ExportOption> own) {
  own.insert(own.end(),
             {{"--refine", "M,N", "leaves of an octree: at most M levels up (0 to 16), with N layers of cells around what is fine (default 2)"},
              {"--want", "KIND=L,...", "what is to be of level L: interface, patch:NAME, material:NAME, inside:NAME, box:X0,Y0,Z0,X1,Y1,Z1"},
              {"--threads", "N", "how many threads, 1 to 1024 (default: one per core)"},
              {"--tmp", "DIR", "the folder for temporary files (default: the system's)"}});
  return own;
}

void expect_refined(const Export& e) {
  if (e.has("--refine")) return;
  for (const ExportOption& option : refined_options())
    if (e.has(option.name)) throw UsageError(fmt::format("{}: expected --refine M,N with it, found none", option.name));
}

RefinedGrid::RefinedGrid(const Export& e, double share)
    : refinement_(parse_refinement(e.reader.meta(), value_of(e, "--refine", ""), value_of(e, "--want", ""), "--refine", "--want")),
      threads_(static_cast<int>(e.integer("--threads", 1, 1024, std::max(1U, std::thread::hardware_concurrency())))) {
  if (e.level != 0) throw UsageError(fmt::format("--level: expected 0 with --refine, whose leaves are made of cells of level 0, found {}", e.level));
  leaves_ = std::make_unique<Leaves>(e.reader, refinement_, value_of(e, "--tmp", temporary_folder()));
  const SetValue number = e.number();
  for (Label label = 0; label < e.reader.meta().labels.size(); ++label) numbers_.push_back(number({label}));
  e.progress(0);
  leaves_->prepare(e.box, threads_, [&](double done) { e.progress(share * done); });
}

}  // namespace teracell::exports
