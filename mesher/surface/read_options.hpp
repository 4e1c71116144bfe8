// What a reader of surface files is told besides the file and the part. A format that needs more, such as a tolerance, gets a
// field here, with a default that suits the other formats.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

#include "store/base/spill.hpp"

namespace teracell::inline store {
class Background;
}

namespace teracell::mesher {

// For reading outside of a run, which has a budget of its own: what exceeds a gigabyte lies on disk.
inline Budget modest_budget() { return {.bytes = uint64_t{1} << 30, .folder = std::filesystem::temp_directory_path()}; }

class KeptTrees;
struct Part;

struct ReadOptions {
  Budget budget;                 // vertices that must be kept stay within it; others are kept on disk
  std::string units;             // coordinates of a file that states its unit are converted to these; empty: they stay as they are
  KeptTrees* kept = nullptr;     // keeps files with a tree for the next call
  Background* helper = nullptr;  // may do part of the parsing; it may have other jobs
  // Called before the first facet by a reader that knows about how many there are.
  std::function<void(uint64_t)> expect = [](uint64_t) {};
  // Called when the facets that follow belong to another patch, with its number in SurfaceFile::patches; before the first facet, too.
  std::function<void(uint32_t)> enter_patch = [](uint32_t) {};
  // Called for each part of a tree that is wanted, after enter_patch. Where it returns true the sink gets none of its facets: whoever asks
  // takes them from `kept` when they are needed.
  std::function<bool(const Part&)> take_part = nullptr;
};

}  // namespace teracell::mesher
