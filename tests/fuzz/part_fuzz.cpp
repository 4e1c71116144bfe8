// A part of a grid with any bytes under right checksums: verify and merge end with an Error, or with a file that can be opened and read.
//
// The lower two bits of the first byte choose one of three parts. The next three choose what the rest of the input is: edits of that part,
// one of its sections, or a whole file.
#include <cstdlib>
#include <fstream>

#include <unistd.h>

#include "mesher/parts/merge.hpp"
#include "mesher/pipeline.hpp"
#include "store/write/part.hpp"
#include "tests/fuzz/read_file.hpp"
#include "tests/support/forged_part.hpp"

namespace teracell::mesher {
namespace {

using namespace testing;

constexpr auto kSilent = [](const char*, double, double) {};
const std::atomic<bool> kGoOn{false};

// A tetrahedron that lacks a facet, and a leaf thinner than a cell, so that there are holes, warnings and lost stretches. The grid has index
// pages that lie in one part and others that lie in several.
class Sound {
 public:
  Sound() : folder_(std::filesystem::temp_directory_path() / ("part_fuzz." + std::to_string(::getpid()))) {
    std::filesystem::create_directory(folder_);
    std::ofstream(folder_ / "open.obj") << "v 0 0 0\nv 9 0 0\nv 0 9 0\nv 0 0 5\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    std::ofstream(folder_ / "leaf.obj") << "v 1 1 1\nv 8 1 1\nv 1 8 1.01\nv 1 1 1.01\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    const Scene scene = parse_scene(
        R"({"grid": {"min": [-1, -1, -1], "max": [12, 12, 7], "cells": [130, 130, 11]}, "materials": {"air": {}, "tin": {}, "wax": {}}, "background": "air",
            "bodies": [{"name": "open", "mesh": "open.obj", "material": "tin"}, {"name": "leaf", "mesh": "leaf.obj", "material": "wax", "thin": "keep"}]})",
        folder_);
    MeshOptions options{.axis = 2, .threads = 1, .thin = true, .fractions = Subdivision{2, 2, 4}, .links = true, .chunk_rays = 4};
    for (uint32_t i = 0; i < 3; ++i) {
      options.shard = Shard{i, 3};
      mesh(scene, output(), options, kSilent, kGoOn);
      paths_.push_back(part_path(output(), *options.shard));
      sections_.push_back(take_apart(file_bytes(paths_.back())));
    }
    merge(paths_, output(), kSilent, kGoOn);
  }
  ~Sound() { std::filesystem::remove_all(folder_); }

  const PartSections& sections(size_t part) const { return sections_[part]; }
  std::filesystem::path output() const { return folder_ / "g.tcell"; }
  void verify_and_merge(size_t number, const Bytes& part) const {
    std::vector<std::filesystem::path> paths = paths_;
    write_bytes(paths[number] = folder_ / "forged", part);
    try {
      verify(PartReader(paths[number]));
    } catch (const Error&) {
    }
    try {
      merge(paths, output(), kSilent, kGoOn);
    } catch (const Error&) {
      return;
    }
    read_file(file_bytes(output()));
  }

 private:
  const std::filesystem::path folder_;
  std::vector<std::filesystem::path> paths_;
  std::vector<PartSections> sections_;
};

// Edits of four bytes each: the section; where (14 bits) and what to do there (2 bits); a byte to do it with.
template <class Text>
void edit(Text& text, size_t place, uint8_t how, uint8_t byte) {
  using Char = typename Text::value_type;
  const size_t at = text.empty() ? 0 : place % text.size();
  if (text.empty() || how == 0) text.insert(text.begin() + static_cast<ptrdiff_t>(at), static_cast<Char>(byte));
  else if (how == 1) text[at] = static_cast<Char>(byte);
  else if (how == 2) text[at] = static_cast<Char>(text[at] ^ byte);
  else text.resize(at);
}

Bytes forged(uint8_t how, PartSections sections, std::span<const uint8_t> input) {
  const Bytes bytes(input.begin(), input.end());
  switch (how) {
    case 0: return bytes;
    case 1: sections.head.assign(input.begin(), input.end()); break;
    case 2: sections.metadata.assign(input.begin(), input.end()); break;
    case 3: sections.records = bytes; break;
    case 4: sections.found = bytes; break;
    default:
      for (size_t i = 0; i + 4 <= input.size(); i += 4) {
        const size_t place = (input[i + 1] | input[i + 2] << 8) % (1 << 14);
        const uint8_t what = input[i + 2] >> 6, byte = input[i + 3];
        switch (input[i] % 5) {
          case 0: edit(sections.head, place, what, byte); break;
          case 1: edit(sections.metadata, place, what, byte); break;
          case 2: edit(sections.records, place, what, byte); break;
          case 3: edit(sections.found, place, what, byte); break;
          default: edit(sections.grid, place, what, byte);
        }
      }
  }
  return put_together(sections);
}

}  // namespace
}  // namespace teracell::mesher

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace teracell;
  using namespace teracell::mesher;
  static const Sound sound;
  if (size == 0) return 0;
  const size_t number = data[0] % 4 % 3;
  sound.verify_and_merge(number, forged(data[0] / 4 % 8, sound.sections(number), {data + 1, size - 1}));
  return 0;
}
