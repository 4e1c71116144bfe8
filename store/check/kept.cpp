#include "store/check/kept.hpp"

#include <algorithm>

#include "store/base/error.hpp"
#include "store/base/file.hpp"
#include "store/check/check_json.hpp"

namespace teracell::inline store {
namespace {

constexpr uint64_t kMostBytes = uint64_t{64} << 20, kEnds = 256;

std::string piece(const InputFile& file, uint64_t offset, uint64_t bytes) {
  std::string text(bytes, '\0');
  file.read(offset, {reinterpret_cast<uint8_t*>(text.data()), text.size()});
  return text;
}

std::string without_line_break(std::string text) {
  if (text.ends_with('\n')) text.pop_back();
  return text;
}

// By the hash of the file if it can be, since that of the cells takes the whole index.
bool is_for(const GridReader& reader, std::string_view document) {
  const GridHashes hashes = hashes_in(document);
  return hashes.grid == reader.hash() || (!hashes.cells.empty() && hashes.cells == reader.cells_hash());
}

}  // namespace

std::filesystem::path kept_findings(const std::filesystem::path& grid) { return std::filesystem::path(grid).replace_extension(".check.json"); }

bool has_kept_findings(const std::filesystem::path& grid, const GridReader& reader) try {
  const std::filesystem::path path = kept_findings(grid);
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return false;
  const InputFile file(path);
  const uint64_t ends = std::min(file.size(), kEnds);
  if (file.size() > kMostBytes || !ends_as_whole(without_line_break(piece(file, file.size() - ends, ends)))) return false;
  return is_for(reader, piece(file, 0, ends));
} catch (const FormatError&) {  // who reads the cells is told
  return false;
} catch (const IoError&) {  // who reads the findings is told
  return false;
}

std::string read_kept_findings(const std::filesystem::path& grid, const GridReader& reader) {
  const std::filesystem::path path = kept_findings(grid);
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return "";
  const InputFile file(path);
  if (file.size() > kMostBytes) return "";
  const std::string text = without_line_break(piece(file, 0, file.size()));
  return is_whole(text) && is_for(reader, text) ? with_grid_hash(text, reader.hash()) : "";
}

}  // namespace teracell::store
