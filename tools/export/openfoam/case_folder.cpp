#include "tools/export/openfoam/case_folder.hpp"

#include <fmt/format.h>

#include "store/base/error.hpp"

namespace fs = std::filesystem;

namespace teracell::exports::foam {
namespace {

constexpr char kAside[] = "polyMesh-export";

void check(const fs::path& path, const char* what, const std::error_code& error) {
  if (error) throw IoError(fmt::format("{}: {}: {}", path.string(), what, error.message()));
}

bool make_folder(const fs::path& path) {
  std::error_code error;
  const bool made = fs::create_directory(path, error);
  check(path, "can't create the folder of the case", error);
  return made;
}

}  // namespace

CaseFolder::CaseFolder(const fs::path& path, uint32_t parts, bool divided)
    : path_(path.has_filename() ? path : path.parent_path()), parts_(parts), divided_(divided), made_(make_folder(path_)) {
  try {
    std::error_code ignored;
    if (fs::exists(fs::symlink_status(path_ / kAside, ignored)))
      throw UsageError(fmt::format("{}: expected no folder of this name, which a run has left that was killed as it ended: remove it{}",
                                   (path_ / kAside).string(), divided_ ? ", and the meshes of processors that it had moved out of it" : ""));
    expect_free();
    aside_.emplace(path_ / kAside, "none");
  } catch (...) {
    std::error_code ignored;
    if (made_) fs::remove(path_, ignored);
    throw;
  }
}

CaseFolder::~CaseFolder() {
  aside_.reset();
  std::error_code ignored;
  if (made_) fs::remove(path_, ignored);  // if nothing came to be in it
}

fs::path CaseFolder::place(uint32_t part) const {
  return (divided_ ? fs::path(fmt::format("processor{}", part)) : fs::path()) / "constant" / "polyMesh";
}

fs::path CaseFolder::mesh(uint32_t part) const { return aside_->path() / place(part); }

// Meshes for another number of ranks would be taken for parts of this one, so none may be there.
void CaseFolder::expect_free() const {
  const auto refuse = [](const fs::path& mesh) {
    std::error_code ignored;
    if (fs::exists(fs::symlink_status(mesh, ignored)))
      throw UsageError(fmt::format("{}: expected a case without a mesh, found this one: remove it, or write to another folder", mesh.string()));
  };
  if (!divided_) return refuse(path_ / "constant" / "polyMesh");
  std::error_code error;
  for (fs::directory_iterator at(path_, error), end; !error && at != end; at.increment(error))
    if (at->path().filename().string().starts_with("processor")) refuse(at->path() / "constant" / "polyMesh");
  check(path_, "can't read", error);
}

void CaseFolder::commit() {
  expect_free();  // once more, since a run may take hours
  aside_->commit();
  aside_.reset();
  for (uint32_t part = 0; part < parts_; ++part) {
    const fs::path from = path_ / kAside / place(part), to = path_ / place(part);
    std::error_code error;
    fs::create_directories(to.parent_path(), error);
    if (!error) fs::rename(from, to, error);
    check(to, fmt::format("the mesh is complete, but can't be moved here from {}", from.string()).c_str(), error);
  }
  std::error_code ignored;
  fs::remove_all(path_ / kAside, ignored);
}

}  // namespace teracell::exports::foam
