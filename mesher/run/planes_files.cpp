#include "mesher/run/planes_files.hpp"

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/output_file.hpp"

namespace teracell::mesher {

std::filesystem::path planes_path(const std::filesystem::path& folder, int axis) { return folder / (axis_name(axis) + ".txt"); }

void write_planes(const Grid& grid, const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw IoError(fmt::format("{}: can't make this folder for planes: {}", folder.string(), error.message()));
  constexpr int64_t kTogether = 4096;  // planes
  for (int d = 0; d < 3; ++d) {
    const Axis& axis = grid.axis[d];
    OutputFile file(planes_path(folder, d));
    std::string text;
    for (int64_t i = 0; i <= axis.cells(); ++i) {
      text += fmt::format("{}\n", axis.plane(i));
      if (i % kTogether != kTogether - 1 && i < axis.cells()) continue;
      file.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
      text.clear();
    }
    file.commit();
  }
}

}  // namespace teracell::mesher
