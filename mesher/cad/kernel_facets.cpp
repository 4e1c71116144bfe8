#include "mesher/cad/kernel_facets.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "mesher/cad/facets_file.hpp"
#include "store/base/bytes.hpp"
#include "store/base/error.hpp"
#include "store/text/json_node.hpp"

namespace teracell::mesher {
namespace {

// The bytes of the file from front to back.
class FacetBytes {
 public:
  FacetBytes(const Descriptor& file, uint64_t size, const std::string& name) : file_(file), size_(size), name_(name) {}
  void read(void* to, size_t bytes) {
    auto* out = static_cast<uint8_t*>(to);
    while (bytes > 0) {
      if (used_ == block_.size()) refill();
      const size_t some = std::min(bytes, block_.size() - used_);
      std::memcpy(out, block_.data() + used_, some);
      out += some, used_ += some, bytes -= some;
    }
  }
  uint64_t left() const { return size_ - at_ + (block_.size() - used_); }
  [[noreturn]] void fail(const std::string& what) const { throw FormatError(fmt::format("{}: the CAD kernel's facets: {}", name_, what)); }

 private:
  void refill() {
    if (at_ == size_) fail("too short");
    block_.resize(std::min<uint64_t>(size_ - at_, 1 << 18));
    if (file_.read(at_, block_) < block_.size()) fail("can't be read");
    at_ += block_.size();
    used_ = 0;
  }
  const Descriptor& file_;
  const uint64_t size_;
  const std::string& name_;
  Bytes block_;
  size_t used_ = 0;
  uint64_t at_ = 0;
};

// What the kernel rounded to nearly nothing is 0: only a user's own coordinates are refused for that.
Vec3 vertex_in(FacetBytes& in) {
  Vec3 v;
  in.read(v.data(), sizeof v);
  for (double& x : v)
    if (!is_coordinate(x)) x = std::abs(x) < 1e-75 ? 0 : checked_coordinate(x, "a vertex of the CAD kernel");
  for (double& x : v) x += 0.0;
  return v;
}

}  // namespace

void read_kernel_facets(const Descriptor& file, uint64_t size, const std::string& name, const Factor& factor, Shapes& shapes,
                        std::vector<CadShape>& facts) {
  FacetBytes in(file, size, name);
  std::array<char, kFacetsMagic.size()> magic;
  uint64_t head_size = 0;
  in.read(magic.data(), magic.size());
  in.read(&head_size, sizeof head_size);
  if (std::string_view(magic.data(), magic.size()) != kFacetsMagic || head_size > in.left()) in.fail("expected others");
  std::string head(head_size, '\0');
  in.read(head.data(), head.size());
  const Json json = parse_json(head, "the CAD kernel's facets");
  const JsonNode root(json, "the CAD kernel's facets");
  const JsonNode shape_list = root.require("shapes");
  const std::vector<JsonNode> list = shape_list.items(facts.size());
  const double length = factor.value();
  for (size_t i = 0; i < list.size(); ++i) {
    const JsonNode& s = list[i];
    CadShape& shape = facts[i];
    shape.faces_without_facets = s.require("faces_without_facets").whole();
    shape.closed = s.require("closed").boolean();
    shape.facet_volume = s.require("facet_volume").number();
    shape.facet_area = s.require("facet_area").number();
    shape.kernel_volume = s.number_or_null("kernel_volume");
    shape.scale(length * length * length, length * length);
    const uint64_t vertices = s.require("vertices").whole(in.left() / sizeof(Vec3));
    const uint32_t set = shapes.begin_vertices(false);
    for (uint64_t v = 0; v < vertices; ++v) shapes.add_vertex(vertex_in(in), factor, name);
    shapes.begin_shape(true);  // a part, even if the kernel makes no facets of it
    s.each("groups", [&](const JsonNode& g) {
      const uint64_t triangles = g.require("triangles").whole(in.left() / 12);
      shapes.begin_group(g.require("color").any_text());
      for (uint64_t t = 0; t < triangles; ++t) {
        std::array<uint32_t, 3> numbers;
        in.read(numbers.data(), sizeof numbers);
        if (std::ranges::any_of(numbers, [&](uint32_t n) { return n >= vertices; })) in.fail("expected the number of a vertex");
        shapes.add_triangle(set, numbers);
      }
    });
  }
  if (in.left() > 0) in.fail("expected nothing more");
}

}  // namespace teracell::mesher
