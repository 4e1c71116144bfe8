// teracell page: the dashboard without a server.
#include <algorithm>
#include <deque>

#include <fmt/format.h>

#include "server/page/static_page.hpp"
#include "store/base/error.hpp"
#include "store/check/kept.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/notice.hpp"
#include "tools/cli/progress.hpp"

namespace teracell::cli {
namespace {

struct PageArguments {
  std::vector<std::string> grids;
  SourceOptions source;
  std::string output, progress = "auto";
};

void run(const PageArguments& o) {
  server::expect_module(server::embedded_page());
  if (is_address(o.output)) throw UsageError(fmt::format("{}: expected a folder or a file of this machine, found an address", o.output));
  const std::string ending = CLI::detail::to_lower(std::filesystem::path(o.output).extension().string());
  const bool whole = ending == ".html" || ending == ".htm";
  if (whole && o.grids.empty()) throw UsageError("page: expected the grids that are to be in the page: teracell page g.tcell -o g.html");
  if (whole) check_output(o.grids, o.output);

  std::deque<GridReader> readers;  // a file that is no grid is refused
  std::vector<server::PageGrid> grids;
  for (const std::string& name : o.grids) {
    const std::string path = is_address(name) ? name.substr(0, name.find_first_of("?#")) : name,
                      file = std::filesystem::path(path).filename().string();
    if (!whole && is_address(name)) {
      if (!name.starts_with("http")) throw UsageError(fmt::format("{}: a browser reads https:// addresses only: give that of the same object", name));
      if (file.empty() || path.find("///") != path.npos || path.find('/', path.find("://") + 3) == path.npos ||
          std::ranges::any_of(name, [](unsigned char c) { return c <= ' ' || c == 127; }))
        throw UsageError(fmt::format("'{}': expected the address of a .tcell file, such as https://host/g.tcell", name));
      grids.push_back({file, name, nullptr});
    } else {
      readers.emplace_back(open_source(name, o.source));
      grids.push_back({file, "", &readers.back().source(), is_address(name) ? "" : read_kept_findings(name, readers.back()), readers.back().hash()});
    }
  }
  const Wanted wanted = until_interrupted(o.output, whole ? "nothing was written" : "its index.html stays as it was, other files may be new");
  ProgressLine line(o.progress, "");
  const auto progress = [&](double share) { line("page", share); };
  if (whole) write_whole_page(server::embedded_page(), grids, o.output, progress);
  else write_site(server::embedded_page(), notice(), grids, o.output, progress);
}

}  // namespace

Run setup_page(CLI::App& app) {
  const auto o = std::make_shared<PageArguments>();
  app.add_option("grid,--grids", o->grids,
                 ".tcell files, or addresses (https://..., s3://...); in a folder, files are copied and https addresses are listed");
  app.add_option("-o,--output", o->output, "a folder for the files of the page, or one file if the name ends with .html or .htm")->required();
  add_source_options(app, o->source);
  add_progress(app, o->progress);
  app.footer(
      "The page reads the grids by itself: no server is needed. A folder is for any host of static files that answers ranges of bytes; one HTML\n"
      "file, which holds the grids, opens from a disk or a mail. `teracell pack` makes grids that need fewer requests. Examples:\n"
      "  teracell page -o site/ --grids packed.tcell\n  teracell page g.tcell -o g.html");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
