// An array and the text that describes it, in files of their own.
#pragma once
#include "store/base/output_file.hpp"
#include "tools/export/format.hpp"

namespace teracell::exports {

// The name of a file that is written beside the output. Throws UsageError if it is the grid.
const std::filesystem::path& expect_other_file(const Export& e, const std::filesystem::path& file);

// The text appears last, so whoever finds it finds the array too.
class TwoFiles {
 public:
  // Throws UsageError if one of them is the grid.
  TwoFiles(const Export& e, const std::filesystem::path& array, const std::filesystem::path& text);
  OutputFile& array() { return array_; }
  // Gives both files their names. When it throws, there is no text.
  void commit(const std::string& text);

 private:
  const std::filesystem::path text_name_;
  OutputFile array_, text_;
};

// Writes an array by append(file), and with the option --header also describe() beside it, as OUTPUT.txt.
void write_array(const Export& e, const std::string& type, const std::string& order, const std::function<void(OutputFile&)>& append);
ExportOption header_option();

// What the array holds, line by line: for people, and for programs that read "key: value". `type` says what a number is, `order` how
// they follow each other.
std::string describe(const Export& e, const std::filesystem::path& array, const std::string& type, const std::string& order);

}  // namespace teracell::exports
