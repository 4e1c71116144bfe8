// A format that cells are exported to. Each has a file of its own and one line in formats.cpp.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "store/grid/set_value.hpp"
#include "store/read/reader.hpp"

namespace teracell::exports {

// What is exported, and where to. REQUIRES: the reader has the level, and the box is not empty and lies within it.
struct Export {
  const GridReader& reader;
  int level;
  Box box;  // in cells of the level
  std::filesystem::path output;
  // Called again and again with the share that is done, from 0 to 1. What it throws ends the export, and nothing is left of it.
  std::function<void(double share)> progress;
  std::vector<uint32_t> map = {};                      // the number that is written for each material id; empty: the id itself
  std::map<std::string, std::string> options = {};     // those of ExportFormat::options that were given
  // Called, when all is written, with what a user is to know besides.
  std::function<void(const std::string& sentence)> tell = [](const std::string&) {};

  // What is written for a cell, and the largest number that can occur.
  SetValue number() const;
  uint32_t most() const;
  bool has(const std::string& option) const { return options.contains(option); }
  // Materials by id, from NAME,NAME... REQUIRES: the option was given. Throws UsageError.
  std::vector<bool> materials(const std::string& option) const;
  // A whole number, or `otherwise` when the option was not given. Throws UsageError.
  int64_t integer(const std::string& option, int64_t least, int64_t most, int64_t otherwise) const;
};

// The names of chosen materials, for a message: as listed() has them.
std::string chosen_names(const std::vector<MaterialInfo>& materials, const std::vector<bool>& chosen);

// An option that one format takes beside those of all.
struct ExportOption {
  std::string name;      // as it is typed: "--ranks"
  std::string argument;  // what it takes: "N"; empty: it is a switch
  std::string help;
};

struct ExportFormat {
  std::string name;                     // of the option --format
  std::vector<std::string> extensions;  // with the dot; none when --format alone can choose it
  std::string holds;                    // one line for people
  // Writes the output, whole or not at all: one file by way of OutputFile, or one folder by way of OutputFolder. The memory that
  // it takes does not grow with the box.
  void (*write)(const Export&);
  bool numbers = true;  // whether numbers stand for the materials, so that Export::map makes sense
  std::vector<ExportOption> options = {};
  bool coarser = false;  // whether the levels above the chosen one are written, too: their cells may reach beyond the box
};

}  // namespace teracell::exports
