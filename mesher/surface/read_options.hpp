// What a reader of surface files is told besides the file and the part. A format that needs more, such as a tolerance, gets a
// field here, with a default that suits the other formats.
#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "mesher/surface/facet.hpp"
#include "store/base/spill.hpp"

namespace teracell::inline store {
class Background;
}

namespace teracell::mesher {

// For reading outside of a run, which has a budget of its own: what exceeds a gigabyte lies on disk.
inline Budget modest_budget() { return {.bytes = uint64_t{1} << 30, .folder = std::filesystem::temp_directory_path()}; }

class IdleKernels;
class KeptTrees;
struct Part;

// How the CAD kernel turns curved surfaces, as STEP files have them, into facets, and what it may take for that.
struct CadOptions {
  std::optional<double> deflection;         // the largest chord error, in the units that are asked for; absent: kOfBox of the file's box
  double angle = 12;                        // the largest angle between neighbouring chords, in degrees
  int threads = 0;                          // 0: as many as the machine has
  uint64_t memory = uint64_t{8} << 30;      // bytes
  double seconds = 1800;                    // for reading the file, and for making its facets
  std::filesystem::path cache;              // folder for what it made; empty: that of the user
  std::shared_ptr<IdleKernels> kernels;     // keeps kernels that have read a file for the next question about it; null: nobody does
  std::function<void(double)> waiting = [](double) {};  // called now and then while the kernel works, with the share that is done; may throw
  static constexpr double kOfBox = 1e-4;
};

inline std::shared_ptr<const CadOptions> cad_or_usual(const std::shared_ptr<const CadOptions>& cad) {
  static const auto usual = std::make_shared<const CadOptions>();
  return cad ? cad : usual;
}

inline constexpr uint32_t kNoVertexNumber = ~uint32_t{0};

// Takes the facets of a file in blocks, on several threads, where its format lets a reader tell facets apart without parsing them one by one. Then
// the sink gets none of them.
struct FacetBlocks {
  static constexpr size_t kFacets = 4096, kSome = 256;  // of each block but the last one, and of its parts but the last one

  // How many threads of a run read blocks. Each takes up to 2 MB.
  static int readers(const Budget& budget, int threads) {
    return static_cast<int>(std::clamp<uint64_t>(budget.bytes >> 23, 1, static_cast<uint64_t>(std::clamp(threads, 1, 8))));
  }
  int threads = 1;
  Background* idle = nullptr;  // its thread may be one of them; take() must not use it
  uint64_t ahead = 1;          // so many outcomes of take() may wait for their turn, for each thread
  // Whether the facets are to come this way: asked once before the first one, after expect() and enter_patch(). `float32`: as SurfaceFile's.
  std::function<bool(bool float32)> wanted;
  // Takes a block on any of the threads, `worker` in [0, threads); 0 is the calling one. Each call of next() gives some more of its facets, which lie
  // in the cache then, and after the last ones none. Returns what is to be done on the calling thread, in the order of the blocks.
  std::function<std::function<void()>(const std::function<std::span<const Facet>()>& next, int worker)> take;
};

struct ReadOptions {
  Budget budget;  // vertices that must be kept stay within it; others are kept on disk
  std::string units;  // coordinates of a file that states its unit are converted to these; empty: they stay as they are
  KeptTrees* kept = nullptr;  // keeps files with a tree for the next call
  std::shared_ptr<const CadOptions> cad = cad_or_usual(nullptr);  // never null
  bool face_patches = false;  // of a part, faces with a colour of their own are patches: "/as1/plate:red"
  bool outline = false;  // only the tree is wanted: shapes of exact surfaces may stand for facets that are not made
  Background* helper = nullptr;  // may do part of the parsing; it may have other jobs
  // Called before the first facet by a reader that knows about how many there are.
  std::function<void(uint64_t)> expect = [](uint64_t) {};
  // Called when the facets that follow belong to another patch, with its number in SurfaceFile::patches; before the first facet, too.
  std::function<void(uint32_t)> enter_patch = [](uint32_t) {};
  // If not null, it must outlive the call of the reader.
  const FacetBlocks* blocks = nullptr;
  // If not null, holds the numbers that the file gives to the vertices of the facets which the sink gets, from 0 on. Equal numbers are equal
  // vertices, but for kNoVertexNumber, which stands for any that is too large. As many as there are facets; fewer where the format has none, as STL
  // and formats with a tree.
  std::vector<std::array<uint32_t, 3>>* numbers = nullptr;
  // Called for each part of a tree that is wanted, after enter_patch. Where it returns true the sink gets none of its facets: whoever asks
  // takes them from `kept` when they are needed.
  std::function<bool(const Part&)> take_part = nullptr;
};

}  // namespace teracell::mesher
