#include "server/page/static_page.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "server/service/target.hpp"
#include "store/base/output_file.hpp"

namespace teracell::server {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kWholePage = "whole.html", kIndex = "index.html";
constexpr std::string_view kListBegin = "<script id=\"grids\" type=\"application/json\">", kListEnd = "</script>";
constexpr size_t kHeldPiece = 49152;               // bytes of a grid in one element, as in held.ts
constexpr size_t kCopied = size_t{1} << 20;     // that are copied at once

std::span<const uint8_t> bytes_of(std::string_view text) { return {reinterpret_cast<const uint8_t*>(text.data()), text.size()}; }

std::string base64(std::span<const uint8_t> bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t n = std::min<size_t>(3, bytes.size() - i);
    uint32_t three = 0;
    for (size_t k = 0; k < 3; ++k) three = three << 8 | (k < n ? bytes[i + k] : 0u);
    for (size_t k = 0; k < 4; ++k) out += k <= n ? digits[three >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string text_of(std::span<const EmbeddedFile> page, std::string_view name) {
  const auto found = std::ranges::find(page, name, &EmbeddedFile::name);
  if (found == page.end()) throw Error("this program was built without the page that reads grids by itself: build it with -DTERACELL_WASM=ON");
  return unpacked(*found);
}

// The page around its list of grids.
struct Frame {
  std::string before, after;
  explicit Frame(const std::string& html) {
    const size_t begin = html.find(kListBegin), end = html.find(kListEnd, begin);
    if (begin == html.npos || end == html.npos) throw Error("the page has no place for a list of grids: build the program again");
    before = html.substr(0, begin + kListBegin.size());
    after = html.substr(end + kListEnd.size());
  }
};

// JSON with strings that can't end the element that it is in.
std::string in_element(std::string_view json) {
  std::string out;
  for (const char c : json) c == '<' ? out += "\\u003c" : out += c;
  return out;
}

std::string list_of(const std::vector<PageGrid>& grids, bool held) {
  auto list = nlohmann::ordered_json::array();
  for (const PageGrid& grid : grids) {
    nlohmann::ordered_json entry = {{"name", grid.name}};
    if (held) entry["bytes"] = grid.source->size();
    else entry["address"] = grid.source ? percent_encoded(grid.name) : grid.address;
    if (!grid.findings.empty()) entry["checked"] = grid.hash;
    list.push_back(std::move(entry));
  }
  return in_element(list.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace));
}

// An element for what was found in each of the grids that were looked through.
std::string findings_of(const std::vector<PageGrid>& grids) {
  std::string out;
  for (size_t i = 0; i < grids.size(); ++i)
    if (!grids[i].findings.empty())
      out += fmt::format("\n<script id=\"findings-{}\" type=\"application/json\">{}</script>", i, in_element(grids[i].findings));
  return out;
}

class Progress {
 public:
  Progress(const std::vector<PageGrid>& grids, const std::function<void(double)>& say) : say_(say) {
    for (const PageGrid& grid : grids)
      if (grid.source) all_ += grid.source->size();
  }
  void add(uint64_t bytes) { say_(static_cast<double>(done_ += bytes) / static_cast<double>(std::max<uint64_t>(all_, 1))); }

 private:
  const std::function<void(double)>& say_;
  uint64_t all_ = 0, done_ = 0;
};

// Calls f(bytes) for one part of the source after the other.
template <class F>
void for_each_part(const ByteSource& source, size_t size, F&& f) {
  Bytes bytes;
  for (uint64_t at = 0; at < source.size(); at += bytes.size()) {
    bytes.resize(static_cast<size_t>(std::min<uint64_t>(size, source.size() - at)));
    source.read(at, bytes);
    f(bytes);
  }
}

void write(const fs::path& path, std::string_view text) {
  OutputFile out(path);
  out.append(bytes_of(text));
  out.commit();
}

// Whether an older index.html is one of these pages, or there is none.
bool may_replace(const fs::path& index) {
  if (!fs::exists(index)) return true;
  if (!fs::is_regular_file(index)) return false;
  std::ifstream in(index, std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  return text.find(kListBegin) != text.npos;
}

}  // namespace

void expect_module(std::span<const EmbeddedFile> page) { text_of(page, kWholePage); }

void write_site(std::span<const EmbeddedFile> page, std::string_view notice, const std::vector<PageGrid>& grids, const fs::path& folder,
                const std::function<void(double)>& progress) {
  if (folder.empty()) throw UsageError("expected the name of a folder, found ''");
  std::set<std::string> names, own = {"NOTICE", "assets"};
  for (const EmbeddedFile& file : page) own.emplace(file.name);
  for (const PageGrid& grid : grids)
    if (grid.source && own.contains(grid.name))
      throw UsageError(fmt::format("{}: the page has a file of this name: give the grid another one", grid.name));
  for (const PageGrid& grid : grids)
    if (grid.source && !names.insert(grid.name).second)
      throw UsageError(fmt::format("two grids have the name {}: they would be one file in {}", grid.name, folder.string()));
  const Frame frame(text_of(page, kIndex));
  if (fs::exists(folder) && !fs::is_directory(folder))
    throw UsageError(fmt::format("{}: expected a folder, or a name that ends with .html, found a file", folder.string()));
  if (!may_replace(folder / kIndex))
    throw UsageError(fmt::format("{}: it is not a page of teracell, and would be replaced: give another folder", (folder / kIndex).string()));
  if (!fs::exists(folder / kIndex))
    for (const std::string_view name : {std::string_view("NOTICE"), kWholePage})
      if (fs::exists(folder / name))
        throw UsageError(fmt::format("{}: it would be replaced, and is not of a page of teracell: give another folder", (folder / name).string()));
  for (const EmbeddedFile& file : page) {
    const fs::path below = (folder / file.name).parent_path();
    std::error_code error;
    if (fs::create_directories(below, error); error) throw IoError(fmt::format("{}: can't be made a folder: {}", below.string(), error.message()));
  }
  for (const EmbeddedFile& file : page)
    if (file.name != kIndex) write(folder / file.name, unpacked(file));
  write(folder / "NOTICE", notice);
  Progress done(grids, progress);
  for (const PageGrid& grid : grids) {
    if (!grid.source) continue;
    const fs::path target = folder / grid.name;
    if (std::error_code error; fs::equivalent(target, grid.source->name(), error) && !error) continue;  // it lies there already
    OutputFile out(target);
    for_each_part(*grid.source, kCopied, [&](const Bytes& bytes) {
      out.append(bytes);
      done.add(bytes.size());
    });
    out.commit();
  }
  for (const PageGrid& grid : grids)
    if (!grid.findings.empty()) write((folder / grid.name).replace_extension(".check.json"), grid.findings);
  write(folder / kIndex, frame.before + list_of(grids, false) + std::string(kListEnd) + frame.after);
}

void write_whole_page(std::span<const EmbeddedFile> page, const std::vector<PageGrid>& grids, const fs::path& path,
                      const std::function<void(double)>& progress) {
  uint64_t all = 0;
  for (const PageGrid& grid : grids) all += grid.source->size() + grid.findings.size();
  if (all > kMostHeld)
    throw UsageError(
        fmt::format("{}: expected grids of at most {} bytes, since a browser holds all of the page in memory, found {}: write a folder for "
                    "a host of files instead (-o SITE/)",
                    path.string(), kMostHeld, all));
  const Frame frame(text_of(page, kWholePage));
  Progress done(grids, progress);
  OutputFile out(path);
  out.append(bytes_of(frame.before + list_of(grids, true) + std::string(kListEnd) + findings_of(grids)));
  for (size_t i = 0; i < grids.size(); ++i)
    for_each_part(*grids[i].source, kHeldPiece, [&](const Bytes& bytes) {
      out.append(bytes_of(fmt::format("\n<script type=\"text/plain\" class=\"grid-{}\">{}</script>", i, base64(bytes))));
      done.add(bytes.size());
    });
  out.append(bytes_of(frame.after));
  out.commit();
}

}  // namespace teracell::server
