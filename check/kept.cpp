#include "check/kept.hpp"

#include "check/check_json.hpp"
#include "store/file.hpp"

namespace teracell {
namespace {

constexpr uint64_t kMostBytes = uint64_t{64} << 20;

}  // namespace

std::filesystem::path kept_findings(const std::filesystem::path& grid) { return std::filesystem::path(grid).replace_extension(".check.json"); }

std::string read_kept_findings(const std::filesystem::path& grid, const std::string& hash) {
  const std::filesystem::path path = kept_findings(grid);
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return "";
  const InputFile file(path);
  if (file.size() > kMostBytes) return "";
  std::string text(file.size(), '\0');
  file.read(0, {reinterpret_cast<uint8_t*>(text.data()), text.size()});
  if (hash.empty() || hash_in(text) != hash) return "";
  while (text.ends_with('\n')) text.pop_back();
  return text;
}

}  // namespace teracell
