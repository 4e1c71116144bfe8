#include "tests/tools/export/foam_files.hpp"

#include "tests/support/meshed.hpp"

namespace fs = std::filesystem;

namespace teracell::testing::foam {
namespace {

// A file of OpenFOAM from its header on.
class FoamText {
 public:
  explicit FoamText(const fs::path& path) : text_(bytes_of(path)), at_(text_.find("}\n") + 2) { REQUIRE(text_.starts_with("FoamFile\n{\n")); }
  bool next_is(char c) {
    skip();
    return at_ < text_.size() && text_[at_] == c;
  }
  bool at_end() {
    skip();
    return at_ == text_.size();
  }
  std::string word() {
    skip();
    const size_t begin = at_;
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) == 0 && text_[at_] != ';' && text_[at_] != '(') ++at_;
    return text_.substr(begin, at_ - begin);
  }
  void expect(char c) {
    REQUIRE(next_is(c));
    ++at_;
  }
  int64_t number() { return std::stoll(word()); }
  template <class T>
  std::vector<T> list() {
    std::vector<T> out(static_cast<size_t>(number()));
    if (out.empty()) return out;
    expect('(');
    REQUIRE(text_.size() - at_ > out.size() * sizeof(T));
    std::memcpy(out.data(), text_.data() + at_, out.size() * sizeof(T));
    at_ += out.size() * sizeof(T);
    expect(')');
    return out;
  }
  // The entries of a dictionary whose values are single words.
  std::map<std::string, std::string> dictionary() {
    std::map<std::string, std::string> out;
    for (expect('{'); !next_is('}');) {
      const std::string key = word();
      skip();
      const size_t end = text_.find(';', at_);
      out[key] = text_.substr(at_, end - at_);
      at_ = end + 1;
    }
    expect('}');
    return out;
  }

 private:
  void skip() {
    while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) ++at_;
  }
  std::string text_;
  size_t at_;
};

template <class T>
std::vector<T> only_list(const fs::path& path) {
  FoamText text(path);
  std::vector<T> out = text.list<T>();
  REQUIRE(text.at_end());
  return out;
}

}  // namespace

std::vector<int32_t> labels_of(const fs::path& file) { return only_list<int32_t>(file); }

PolyMesh::PolyMesh(const fs::path& folder)
    : points(only_list<Vec3>(folder / "points")), owner(only_list<int32_t>(folder / "owner")), neighbour(only_list<int32_t>(folder / "neighbour")) {
  FoamText face_text(folder / "faces");
  const auto begins = face_text.list<int32_t>();
  const auto corners = face_text.list<int32_t>();
  REQUIRE((begins.front() == 0 && begins.back() == static_cast<int32_t>(corners.size()) && std::ranges::is_sorted(begins)));
  for (size_t i = 0; i + 1 < begins.size(); ++i) faces.emplace_back(corners.begin() + begins[i], corners.begin() + begins[i + 1]);
  REQUIRE(owner.size() == faces.size());
  FoamText patch_text(folder / "boundary");
  const int64_t patch_count = patch_text.number();
  for (patch_text.expect('('); !patch_text.next_is(')');) {
    const std::string name = patch_text.word();
    auto d = patch_text.dictionary();
    patches.push_back({name, d["type"], std::stoll(d["nFaces"]), std::stoll(d["startFace"])});
    if (patches.back().type == "processor") patches.back().other = std::stoi(d["neighbProcNo"]);
  }
  REQUIRE(static_cast<int64_t>(patches.size()) == patch_count);
  if (!fs::exists(folder / "cellZones")) return;
  FoamText zone_text(folder / "cellZones");
  const int64_t zone_count = zone_text.number();
  for (zone_text.expect('('); !zone_text.next_is(')');) {
    const std::string name = zone_text.word();
    zone_text.expect('{');
    REQUIRE(zone_text.word() == "type");
    REQUIRE(zone_text.word() == "cellZone");
    zone_text.expect(';');
    REQUIRE(zone_text.word() == "cellLabels");
    REQUIRE(zone_text.word() == "List<label>");
    zones[name] = zone_text.list<int32_t>();
    zone_text.expect(';');
    zone_text.expect('}');
  }
  REQUIRE(static_cast<int64_t>(zones.size()) == zone_count);
}

const Patch& PolyMesh::patch_of(size_t face) const {
  for (const Patch& p : patches)
    if (static_cast<int64_t>(face) >= p.start && static_cast<int64_t>(face) < p.start + p.faces) return p;
  throw std::logic_error("the face has no patch");
}

}  // namespace teracell::testing::foam
