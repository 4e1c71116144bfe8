#include "mesher/scene/names.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "store/grid/metadata.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

size_t edit_distance(std::string_view a, std::string_view b) {
  constexpr size_t kLongest = 64;  // bounds the work on absurdly long keys; real ones differ long before
  a = a.substr(0, kLongest), b = b.substr(0, kLongest);
  std::vector<size_t> row(b.size() + 1);  // distances from the prefix of a so far to every prefix of b
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = std::exchange(row[0], i + 1);
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t replaced = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::string mesh_stem(const std::filesystem::path& mesh) {
  std::filesystem::path file = mesh.filename();
  if (file.extension() == ".gz") file = file.stem();
  const std::string stem = printable(file.stem().string());
  return stem.empty() ? "body" : std::string(first_bytes(stem, kMostStem));
}

std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates) {
  const auto closer = [&](std::string_view a, std::string_view b) { return edit_distance(word, a) < edit_distance(word, b); };
  const auto best = std::min_element(candidates.begin(), candidates.end(), closer);
  return best == candidates.end() ? std::string_view{} : *best;
}

bool resembles(std::string_view word, std::string_view other) { return 2 * edit_distance(word, other) <= std::max(word.size(), other.size()); }

std::string NameBook::numbered(const std::string& stem) {
  if (take(stem)) return stem;
  uint64_t& last = last_.at(stem);  // stays where it is while names are added
  std::string name;
  do name = fmt::format("{}-{}", stem, ++last);
  while (!take(name));
  return name;
}

}  // namespace teracell::mesher
