#include "mesher/scene/names.hpp"

#include <fmt/format.h>

#include "store/grid/metadata.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {

std::string mesh_stem(const std::filesystem::path& mesh) {
  std::filesystem::path file = mesh.filename();
  if (file.extension() == ".gz") file = file.stem();
  const std::string stem = printable(file.stem().string());
  return stem.empty() ? "body" : std::string(first_bytes(stem, kMostStem));
}

std::string NameBook::numbered(const std::string& stem) {
  if (take(stem)) return stem;
  uint64_t& last = last_.at(stem);  // stays where it is while names are added
  std::string name;
  do name = fmt::format("{}-{}", stem, ++last);
  while (!take(name));
  return name;
}

}  // namespace teracell::mesher
