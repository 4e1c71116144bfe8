// A format that cells are exported to. Each has a file of its own and one line in formats.cpp.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "store/reader.hpp"

namespace teracell {

// What is exported, and where to. REQUIRES: the reader has the level, and the box is not empty and lies within it.
struct Export {
  const GridReader& reader;
  int level;
  Box box;  // in cells of the level
  std::filesystem::path output;
  // Called again and again with the share that is done, from 0 to 1. What it throws ends the export, and nothing is left of it.
  std::function<void(double share)> progress;
};

struct ExportFormat {
  std::string name;                     // of the option --format
  std::vector<std::string> extensions;  // with the dot; none when --format alone can choose it
  std::string holds;                    // one line for people
  // Writes the output, whole or not at all: one file by way of OutputFile, or one folder by way of OutputFolder. The memory that
  // it takes does not grow with the box.
  void (*write)(const Export&);
};

}  // namespace teracell
