#include "store/check/kept.hpp"

#include <algorithm>

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

}  // namespace

std::filesystem::path kept_findings(const std::filesystem::path& grid) { return std::filesystem::path(grid).replace_extension(".check.json"); }

bool has_kept_findings(const std::filesystem::path& grid, const std::string& hash) {
  const std::filesystem::path path = kept_findings(grid);
  std::error_code none;
  if (hash.empty() || !std::filesystem::is_regular_file(path, none)) return false;
  const InputFile file(path);
  const uint64_t ends = std::min(file.size(), kEnds);
  return file.size() <= kMostBytes && hash_in(piece(file, 0, ends)) == hash &&
         ends_as_whole(without_line_break(piece(file, file.size() - ends, ends)));
}

std::string read_kept_findings(const std::filesystem::path& grid, const std::string& hash) {
  const std::filesystem::path path = kept_findings(grid);
  std::error_code none;
  if (hash.empty() || !std::filesystem::is_regular_file(path, none)) return "";
  const InputFile file(path);
  if (file.size() > kMostBytes) return "";
  std::string text = without_line_break(piece(file, 0, file.size()));
  return hash_in(text) == hash && is_whole(text) ? text : "";
}

}  // namespace teracell::store
