#include "check/kept.hpp"

#include <algorithm>

#include "check/check_json.hpp"
#include "store/file.hpp"

namespace teracell {
namespace {

constexpr uint64_t kMostBytes = uint64_t{64} << 20, kHead = 256;

// At most so many bytes of a file; nothing when there is none.
std::string beginning(const std::filesystem::path& path, uint64_t most) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return "";
  const InputFile file(path);
  std::string text(std::min(file.size(), most), '\0');
  file.read(0, {reinterpret_cast<uint8_t*>(text.data()), text.size()});
  return text;
}

}  // namespace

std::filesystem::path kept_findings(const std::filesystem::path& grid) { return std::filesystem::path(grid).replace_extension(".check.json"); }

bool has_kept_findings(const std::filesystem::path& grid, const std::string& hash) {
  const std::string begin = beginning(kept_findings(grid), kHead);
  return !hash.empty() && hash_in(begin) == hash;
}

std::string read_kept_findings(const std::filesystem::path& grid, const std::string& hash) {
  if (!has_kept_findings(grid, hash)) return "";
  std::string text = beginning(kept_findings(grid), kMostBytes);
  while (text.ends_with('\n')) text.pop_back();
  return text.ends_with('}') ? text : "";
}

}  // namespace teracell
