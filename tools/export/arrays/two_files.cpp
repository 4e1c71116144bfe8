#include "tools/export/arrays/two_files.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "store/base/error.hpp"
#include "tools/export/place.hpp"

namespace teracell::exports {
namespace {

std::string axis_line(const Export& e, int axis) {
  const Axis& a = e.reader.meta().grid.axis[static_cast<size_t>(axis)];
  if (a.is_graded()) return fmt::format("{} planes: {:.17g}\n", axis_name(axis), fmt::join(planes_of(e, axis), " "));
  return fmt::format("{0} first plane: {1:.17g}\n{0} step: {2:.17g}\n", axis_name(axis), plane_of(e, axis, 0), std::ldexp(a.step(), e.level));
}

}  // namespace

const std::filesystem::path& expect_other_file(const Export& e, const std::filesystem::path& file) {
  std::error_code ignored;  // most are not there yet
  if (std::filesystem::equivalent(e.reader.name(), file, ignored))
    throw UsageError(fmt::format("{}: an input would be overwritten: give the output another name", file.string()));
  return file;
}

TwoFiles::TwoFiles(const Export& e, const std::filesystem::path& array, const std::filesystem::path& text)
    : text_name_(text), array_(expect_other_file(e, array)), text_(expect_other_file(e, text)) {}

void TwoFiles::commit(const std::string& text) {
  text_.append({reinterpret_cast<const uint8_t*>(text.data()), text.size()});
  text_.sync();
  std::error_code ignored;
  std::filesystem::remove(text_name_, ignored);  // an older one describes another array
  array_.commit();
  text_.commit();
}

void write_array(const Export& e, const std::string& type, const std::string& order, const std::function<void(OutputFile&)>& append) {
  if (!e.has("--header")) {
    OutputFile file(e.output);
    append(file);
    return file.commit();
  }
  TwoFiles files(e, e.output, e.output.string() + ".txt");
  append(files.array());
  files.commit(describe(e, e.output, type, order));
}

ExportOption header_option() { return {"--header", "", "the type, order, sizes, planes and names as a text beside it, OUTPUT.txt"}; }

std::string describe(const Export& e, const std::filesystem::path& array, const std::string& type, const std::string& order) {
  const auto& [lo, hi] = e.box;
  std::string text = fmt::format(
      "# cells that teracell exported; sizes and the region are x y z\nfile: {}\ntype: {}\norder: {}\nsizes: {} {} {}\nlevel: {}\n"
      "region: {} {} {} {} {} {}\nunits: {}\n",
      array.filename().string(), type, order, hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2], e.level, lo[0], lo[1], lo[2], hi[0], hi[1], hi[2],
      one_line(e.reader.meta().units));
  for (int axis = 0; axis < 3; ++axis) text += axis_line(e, axis);
  return text + material_lines(e, "material {}: {}\n");
}

}  // namespace teracell::exports
