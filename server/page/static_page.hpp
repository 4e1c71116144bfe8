// The dashboard without a server: its files in a folder, for any host of static files, or as one HTML file with grids in it. In both, an
// element of the page lists the grids, which the page then reads by itself (web/src/module/held.ts).
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "server/page/web.hpp"
#include "store/base/file.hpp"

namespace teracell::server {

inline constexpr uint64_t kMostHeld = uint64_t{256} << 20;  // bytes of the grids in one HTML file: browsers hold all of it in memory

// A grid beside the page or in it.
struct PageGrid {
  std::string name;                      // that of its file
  std::string address;                   // where the page finds it, if it is not copied
  const ByteSource* source = nullptr;    // what is copied
  std::string findings{}, hash{};        // of `teracell check` (store/check/check_json.hpp), and the grid's; empty: nobody has looked through it
};

// Throws Error unless `page` has the module that reads grids.
void expect_module(std::span<const EmbeddedFile> page);

// Writes the page, the text of NOTICE, the grids and their findings ("g.check.json") into `folder`, which is made if need be; index.html comes last.
// Each file appears under its name when it is complete. A file that is there already, with the same name, is replaced; others stay. Throws IoError,
// UsageError if the folder has an index.html of something else or if two grids have one name. progress(share of the bytes) may throw to stop.
void write_site(std::span<const EmbeddedFile> page, std::string_view notice, const std::vector<PageGrid>& grids, const std::filesystem::path& folder,
                const std::function<void(double)>& progress);

// Writes one HTML file that holds the page and the grids. Throws IoError, UsageError for grids larger than kMostHeld.
void write_whole_page(std::span<const EmbeddedFile> page, const std::vector<PageGrid>& grids, const std::filesystem::path& path,
                      const std::function<void(double)>& progress);

}  // namespace teracell::server
