// A scene meshed through files, as a user would, and its cells read back.
#pragma once
#include "mesher/pipeline.hpp"
#include "store/read/query.hpp"
#include "tests/support/oracle.hpp"
#include "tests/support/shapes.hpp"

namespace teracell::testing {

// A folder of its own for every test, removed at the end.
class TempFolder {
 public:
  TempFolder();
  ~TempFolder();
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

// The scene of `bodies` (each written as an OBJ) on `grid`.
mesher::Scene scene_of(const TempFolder& folder, const std::vector<oracle::Body>& bodies, const Grid& grid);
nlohmann::ordered_json mesh_quietly(const mesher::Scene& scene, const std::filesystem::path& output, const mesher::MeshOptions& options = {});
// The grid of `bodies`, meshed and read back.
GridReader meshed_reader(const std::vector<oracle::Body>& bodies, const Grid& grid, const mesher::MeshOptions& options = {});
// Every cell's material of a level, C order [z][y][x].
std::vector<uint32_t> all_cells(const GridReader& reader, int level = 0);
std::string bytes_of(const std::filesystem::path& path);

}  // namespace teracell::testing
