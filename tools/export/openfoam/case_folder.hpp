// The folder of an OpenFOAM case. Meshes are written aside and appear in it when all of them are complete.
#pragma once
#include <optional>

#include "store/base/output_folder.hpp"

namespace teracell::exports::foam {

class CaseFolder {
 public:
  // One mesh in constant/polyMesh, or with `divided` one in processorN/constant/polyMesh for each N below `parts`. The case may exist, but
  // must have no such mesh yet. Throws UsageError or IoError.
  CaseFolder(const std::filesystem::path& path, uint32_t parts, bool divided);
  ~CaseFolder();
  CaseFolder(const CaseFolder&) = delete;
  // Where the mesh of a part is written until commit().
  std::filesystem::path mesh(uint32_t part) const;
  // When it returns, all meshes are on disk and in place. When it throws, either none is in place, or the message says where the rest is.
  void commit();

 private:
  std::filesystem::path place(uint32_t part) const;  // within the case
  void expect_free() const;

  const std::filesystem::path path_;
  const uint32_t parts_;
  const bool divided_;
  const bool made_;  // the case was not there before
  std::optional<OutputFolder> aside_;
};

}  // namespace teracell::exports::foam
