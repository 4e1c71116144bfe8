#include "mesher/formats/gltf_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "mesher/surface/reader.hpp"
#include "store/base/error.hpp"
#include "store/format/format.hpp"
#include "store/text/color.hpp"
#include "store/text/json_text.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

// The JSON is held in memory, and with it one element of a list at a time. What stays of an element is some hundred bytes.
constexpr uint64_t kMostText = uint64_t{48} << 20;
constexpr size_t kMostValues = size_t{1} << 20, kMostElements = size_t{1} << 18;
constexpr uint64_t kMostZeros = uint64_t{1} << 20;  // of an accessor without bytes
constexpr uint64_t kMostTimes = 16;                 // that all accessors together read the bytes of all buffers
constexpr uint64_t kSmallBuffer = uint64_t{1} << 16, kSmallBuffers = uint64_t{1} << 26;  // files that are read as a whole

// Extensions that change no shape. What else a file requires is refused by its name.
constexpr std::array kHarmlessExtensions = {"KHR_materials_", "KHR_texture_",   "KHR_lights_", "EXT_texture_",
                                            "KHR_xmp",        "KHR_animation_", "EXT_lights_", "EXT_mesh_manifold"};

struct ComponentType {
  uint32_t number;
  size_t bytes;
  double most;  // of an integer
};
constexpr ComponentType kComponentTypes[] = {{5120, 1, 127},   {5121, 1, 255},          {5122, 2, 32767},
                                             {5123, 2, 65535}, {5125, 4, 4294967295.0}, {5126, 4, 0}};

const ComponentType& type_of(uint32_t number) { return *std::ranges::find(kComponentTypes, number, &ComponentType::number); }

template <class T>
T little_endian(const char* bytes) {
  uint64_t v = 0;
  for (size_t i = sizeof(T); i-- > 0;) v = v << 8 | static_cast<uint8_t>(bytes[i]);
  T out;
  std::memcpy(&out, &v, sizeof out);  // v's low bytes come first, as the format's do
  return out;
}

double number_at(const char* bytes, uint32_t type) {
  switch (type) {
    case 5120: return static_cast<int8_t>(bytes[0]);
    case 5121: return static_cast<uint8_t>(bytes[0]);
    case 5122: return little_endian<int16_t>(bytes);
    case 5123: return little_endian<uint16_t>(bytes);
    case 5125: return little_endian<uint32_t>(bytes);
    default: return little_endian<float>(bytes);
  }
}

std::string decoded_base64(std::string_view text) {
  std::string out;
  out.reserve(text.size() / 4 * 3);
  uint32_t bits = 0;
  int have = 0;
  for (const char c : text) {
    if (c == '=') break;
    constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const size_t digit = kDigits.find(c);
    if (digit == std::string_view::npos) throw InputError(fmt::format("expected base64, found {}", shown(std::string_view(&c, 1))));
    bits = bits << 6 | static_cast<uint32_t>(digit);
    have += 6;
    if (have < 8) continue;
    have -= 8;
    out += static_cast<char>(bits >> have & 255);
  }
  return out;
}

std::string decoded_percent(std::string_view uri) {
  const auto digit = [](char c) { return c >= '0' && c <= '9' ? c - '0' : (c | 32) >= 'a' && (c | 32) <= 'f' ? (c | 32) - 'a' + 10 : -1; };
  std::string out;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && digit(uri[i + 1]) >= 0 && digit(uri[i + 2]) >= 0) {
      out += static_cast<char>(digit(uri[i + 1]) * 16 + digit(uri[i + 2]));
      i += 2;
    } else out += uri[i];
  }
  return out;
}

std::string name_of(const JsonNode& j) {
  const auto name = j.find("name");
  return name && name->is_string() ? std::string(first_bytes(utf8_of(name->any_text()), kLongestPartName)) : "";
}

bool is_unsigned(uint32_t component_type) { return component_type == 5121 || component_type == 5123 || component_type == 5125; }

uint32_t index(const JsonNode& j) { return static_cast<uint32_t>(j.whole(kMostElements)); }
std::optional<uint32_t> index(const JsonNode& j, std::string_view key) {
  const auto found = j.find(key);
  return found ? std::optional(index(*found)) : std::nullopt;
}
uint64_t whole(const JsonNode& j, std::string_view key, uint64_t otherwise) {
  const auto found = j.find(key);
  return found ? found->whole(uint64_t{1} << 53) : otherwise;
}

Matrix matrix_of(const JsonNode& j) {
  if (const auto given = j.find("matrix")) {
    const auto m = given->numbers<16>();  // column by column
    for (const char* other : {"translation", "rotation", "scale"})
      if (j.find(other)) given->fail(fmt::format("no {} beside it", other));
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) given->fail("a matrix whose last row is 0 0 0 1");
    return {m[0], m[4], m[8], m[12], m[1], m[5], m[9], m[13], m[2], m[6], m[10], m[14]};
  }
  Vec3 translation = {0, 0, 0}, scale = {1, 1, 1};
  std::array<double, 4> rotation = {0, 0, 0, 1};
  if (const auto t = j.find("translation")) translation = t->numbers<3>();
  if (const auto s = j.find("scale")) scale = s->numbers<3>();
  if (const auto r = j.find("rotation")) {
    rotation = r->numbers<4>();
    if (rotation == std::array<double, 4>{0, 0, 0, 0}) r->fail("a quaternion other than 0 0 0 0");
    double square = 0;
    for (const double q : rotation) square += q * q;
    if (!(square > 1e-200 && square < 1e200)) r->fail("a quaternion whose length is from 1e-100 to 1e100");
  }
  return placement(translation, rotation, scale);
}

// Factors of base colours are linear; colours of scenes are sRGB.
std::string color_of(const JsonNode& j) {
  const auto pbr = j.find("pbrMetallicRoughness");
  if (!pbr) return "";
  const auto factor = pbr->find("baseColorFactor");
  if (!factor) return "";
  std::string out = "#";
  const auto linear = factor->numbers<4>();
  for (size_t i = 0; i < 4; ++i) {
    const double c = std::clamp(linear[i], 0.0, 1.0);
    const double coded = i == 3 ? c : c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
    if (i < 3 || c < 1) out += fmt::format("{:02x}", static_cast<int>(std::lround(255 * coded)));
  }
  return out;
}

}  // namespace

GltfFile::GltfFile(Input& input, SurfaceFile& file, const Budget& budget)
    : name_(input.name()), on_disk_(!input.plain_memory()), file_(file), budget_(budget), contents_(std::make_unique<Contents>(input, budget)) {
  read_container(*contents_);
}

void GltfFile::refuse(const std::string& where, const std::string& why) const { throw InputError(fmt::format("{}: {}: {}", name_, where, why)); }

// GLB: 12 bytes, then chunks, each with its length and kind before it; the first is the JSON, the second the buffer.
void GltfFile::read_container(const Contents& contents) {
  constexpr uint64_t kHeader = 12, kChunk = 8;
  uint64_t at = 0, bytes = contents.size();
  std::array<char, kHeader + kChunk> head{};
  contents.read(0, std::span(head).first(std::min<uint64_t>(bytes, head.size())));
  if (std::string_view(head.data(), 4) == "glTF") {
    file_.format = "GLB";
    const auto version = little_endian<uint32_t>(&head[4]), length = little_endian<uint32_t>(&head[8]);
    if (version != 2) refuse("byte 4", fmt::format("expected version 2 of glTF, found {}", version));
    if (length > bytes || length < kHeader + kChunk) refuse("byte 8", fmt::format("cut short: expected {} bytes, found {}", length, bytes));
    at = kHeader + kChunk;
    const uint64_t json = little_endian<uint32_t>(&head[kHeader]);
    if (std::string_view(&head[kHeader + 4], 4) != "JSON" || json > length - at) refuse("byte 12", "expected a chunk of JSON within the file");
    if (const uint64_t next = at + (json + 3) / 4 * 4; next + kChunk <= length) {
      contents.read(next, std::span(head).first(kChunk));
      if (std::string_view(&head[4], 4) == std::string_view("BIN\0", 4))
        binary_at_ = next + kChunk, binary_bytes_ = little_endian<uint32_t>(head.data());
      if (binary_bytes_ > length - std::min<uint64_t>(binary_at_, length))
        refuse(fmt::format("byte {}", next), fmt::format("cut short: expected {} bytes of a buffer, found {}", binary_bytes_, length - binary_at_));
    }
    bytes = json;
  } else file_.format = "glTF";
  if (bytes > kMostText)
    refuse("the JSON", fmt::format("expected at most {} bytes, found {}: put the buffers beside the file, or into a GLB file", kMostText, bytes));
  std::string text(bytes, '\0');
  contents.read(at, text);
  try {
    parse(text);
  } catch (const FormatError& e) {
    throw InputError(fmt::format("{}: {}", name_, e.what()));
  }
}

void GltfFile::parse(const std::string& text) {
  const Json rest = parse_json(text, "the JSON", kMostValues,
                               {.take =
                                    [this](const std::string& list, size_t i, const Json& element) {
                                      const std::string where = fmt::format("{}[{}]", list, i);
                                      naming(where, [&] { take(list, JsonNode(element, where)); });
                                    },
                                .within = "extensions"});
  const JsonNode root(rest, "the JSON");
  const JsonNode asset = root.require("asset");
  const std::string version = asset.require("version").any_text();
  if (!version.starts_with("2.")) asset.require("version").fail("version 2 of glTF");
  scene_ = index(root, "scene");
}

void GltfFile::take(const std::string& list, const JsonNode& j) {
  const auto room = [&](auto& elements) -> auto& {
    if (elements.size() == kMostElements) refuse(list, fmt::format("expected at most {} elements, found more", kMostElements));
    return elements;
  };
  if (list == "nodes") room(nodes_).push_back(node_of(j));
  else if (list == "meshes") room(meshes_).push_back(mesh_of(j));
  else if (list == "accessors") room(accessors_).push_back(accessor_of(j));
  else if (list == "bufferViews")
    room(views_).push_back({index(j.require("buffer")), whole(j, "byteOffset", 0), j.require("byteLength").whole(), whole(j, "byteStride", 0)});
  else if (list == "materials") room(materials_).push_back({name_of(j), color_of(j)});
  else if (list == "buffers") {
    Buffer b;
    if (const auto uri = j.find("uri")) b.uri = uri->any_text();
    b.declared = whole(j, "byteLength", 0);
    room(buffers_).push_back(std::move(b));
  } else if (list == "scenes") {
    std::vector<uint32_t>& scene = room(scenes_).emplace_back();
    j.each("nodes", [&](const JsonNode& n) { scene.push_back(index(n)); });
  } else if (list == "extensionsRequired") {
    const std::string& name = j.any_text();
    const bool read =
        name == "KHR_mesh_quantization" || std::ranges::any_of(kHarmlessExtensions, [&](const char* begin) { return name.starts_with(begin); });
    if (!read) refuse(list, fmt::format("the file can't be read without the extension {}: export it without, uncompressed", shown(name)));
  }
}

GltfNode GltfFile::node_of(const JsonNode& j) const {
  GltfNode node{.name = name_of(j), .mesh = index(j, "mesh"), .matrix = matrix_of(j), .children = {}};
  j.each("children", [&](const JsonNode& c) { node.children.push_back(index(c)); });
  return node;
}

GltfMesh GltfFile::mesh_of(const JsonNode& j) {
  GltfMesh mesh{.name = name_of(j), .primitives = {}};
  const JsonNode primitives = j.require("primitives");
  for (const JsonNode& p : primitives.items()) {
    if (++primitives_ > kMostElements) refuse("meshes", fmt::format("expected at most {} primitives, found more", kMostElements));
    const JsonNode attributes = p.require("attributes");
    const auto positions = index(attributes, "POSITION");
    if (!positions) continue;  // it draws nothing
    mesh.primitives.push_back({*positions, index(p, "indices"), index(p, "material"), static_cast<uint32_t>(whole(p, "mode", 4))});
  }
  return mesh;
}

GltfFile::Accessor GltfFile::accessor_of(const JsonNode& j) const {
  const auto stretch = [](const JsonNode& from, uint32_t type) {
    if (type != 0 && std::ranges::find(kComponentTypes, type, &ComponentType::number) == std::end(kComponentTypes))
      from.require("componentType").fail("5120, 5121, 5122, 5123, 5125 or 5126");
    return Stretch{index(from, "bufferView"), whole(from, "byteOffset", 0), type};
  };
  const auto type_in = [](const JsonNode& from) { return static_cast<uint32_t>(from.require("componentType").whole(1 << 20)); };
  Accessor a;
  a.values = stretch(j, type_in(j));
  a.count = j.require("count").whole(uint64_t{1} << 32);
  a.shape = j.require("type").any_text();
  if (const auto n = j.find("normalized")) a.normalized = n->boolean();
  if (const auto sparse = j.find("sparse")) {
    a.replaced = sparse->require("count").whole(a.count);
    const JsonNode indices = sparse->require("indices"), values = sparse->require("values");
    a.indices = stretch(indices, type_in(indices));
    a.replacements = {index(values.require("bufferView")), whole(values, "byteOffset", 0), a.values.type};
  }
  if (!a.values.view && a.count > kMostZeros) j.require("count").fail(fmt::format("at most {} elements where there is no bufferView", kMostZeros));
  return a;
}

std::vector<uint32_t> GltfFile::roots() const {
  if (scene_ && *scene_ >= scenes_.size()) refuse("scene", fmt::format("expected the number of a scene, found {} of {}", *scene_, scenes_.size()));
  if (!scenes_.empty()) return scenes_[scene_.value_or(0)];
  std::vector<bool> child(nodes_.size());
  for (const GltfNode& n : nodes_)
    for (const uint32_t c : n.children)
      if (c < child.size()) child[c] = true;
  std::vector<uint32_t> out;
  for (uint32_t i = 0; i < nodes_.size(); ++i)
    if (!child[i]) out.push_back(i);
  return out;
}

const GltfFile::Accessor& GltfFile::at(uint32_t accessor) const {
  if (accessor >= accessors_.size()) refuse("meshes", fmt::format("expected the number of an accessor, found {} of {}", accessor, accessors_.size()));
  return accessors_[accessor];
}

bool GltfFile::is_float(uint32_t accessor) const { return at(accessor).values.type == 5126; }

// Calls take(numbers) with the components of each element.
template <class F>
void GltfFile::read_numbers(const Stretch& from, uint64_t count, size_t components, bool normalized, const std::string& where, F&& take) {
  if (!from.view || *from.view >= views_.size()) refuse(where, "expected the number of a bufferView");
  const View& view = views_[*from.view];
  const ComponentType& type = type_of(from.type);
  const uint64_t element = components * type.bytes, stride = view.stride > 0 ? view.stride : element;
  const uint64_t room = view.bytes - std::min(view.bytes, from.offset);
  if (count == 0) return;
  if (stride < element || element > room || (count - 1) > (room - element) / stride)
    refuse(where, fmt::format("expected {} elements of {} bytes, {} apart, within the {} bytes of bufferViews[{}] from {} on", count, element, stride,
                              view.bytes, *from.view, from.offset));
  read_bytes(view.buffer, view.offset, {});
  spend(count * element, where);
  std::vector<char> block;
  const uint64_t together = std::max<uint64_t>(1, (uint64_t{1} << 16) / stride);
  std::array<double, 3> numbers{};
  for (uint64_t done = 0; done < count;) {
    const uint64_t some = std::min(together, count - done);
    block.resize((some - 1) * stride + element);
    read_bytes(view.buffer, view.offset + from.offset + done * stride, block);
    for (uint64_t i = 0; i < some; ++i) {
      for (size_t c = 0; c < components; ++c) {
        double v = number_at(&block[i * stride + c * type.bytes], from.type);
        if (normalized && type.most > 0) v = std::max(v / type.most, -1.0);
        numbers[c] = v;
      }
      take(numbers);
    }
    done += some;
  }
}

void GltfFile::spend(uint64_t bytes, const std::string& where) {
  read_bytes_ += bytes;
  if (read_bytes_ / kMostTimes > all_bytes_ + kMostZeros)
    refuse(where, fmt::format("the accessors read more than {} times the {} bytes that the buffers have", kMostTimes, all_bytes_));
}

// Elements of an accessor, those that are replaced in their places.
template <class F>
void GltfFile::read_elements(const Accessor& a, size_t components, const std::string& where, F&& take) {
  if (a.replaced == 0 && a.values.view) return read_numbers(a.values, a.count, components, a.normalized, where, take);
  if (a.replaced > kMostZeros) refuse(where, fmt::format("expected at most {} elements that are replaced, found {}", kMostZeros, a.replaced));
  if (a.replaced > 0 && !is_unsigned(a.indices.type)) refuse(where, "sparse: expected indices of 8, 16 or 32 bits without a sign");
  std::map<uint64_t, std::array<double, 3>> replaced;  // few
  std::vector<uint64_t> indices;
  read_numbers(a.indices, a.replaced, 1, false, where, [&](const std::array<double, 3>& n) { indices.push_back(static_cast<uint64_t>(n[0])); });
  uint64_t i = 0, done = 0;
  read_numbers(a.replacements, a.replaced, components, a.normalized, where, [&](const std::array<double, 3>& n) { replaced[indices[i++]] = n; });
  if (!replaced.empty() && replaced.rbegin()->first >= a.count)
    refuse(where, fmt::format("expected indices of elements below {}, found {}", a.count, replaced.rbegin()->first));
  const auto one = [&](const std::array<double, 3>& n) {
    const auto other = replaced.find(done++);
    take(other == replaced.end() ? n : other->second);
  };
  if (a.values.view) read_numbers(a.values, a.count, components, a.normalized, where, one);
  else
    for (uint64_t k = 0; k < a.count; ++k) one({0, 0, 0});
}

void GltfFile::read_vectors(uint32_t accessor, const std::function<void(const Vec3&)>& take) {
  const Accessor& a = at(accessor);
  const std::string where = fmt::format("accessors[{}]", accessor);
  if (a.shape != "VEC3") refuse(where, fmt::format("expected the type VEC3, found {}", shown(a.shape)));
  uint64_t done = 0;
  read_elements(a, 3, where, [&](const Vec3& v) {
    Vec3 out;
    for (size_t d = 0; d < 3; ++d)
      out[d] = is_coordinate(v[d]) ? v[d] + 0.0 : checked_coordinate(v[d], fmt::format("{}: {}: element {}", name_, where, done));
    ++done;
    take(out);
  });
}

void GltfFile::read_scalars(uint32_t accessor, const std::function<void(uint64_t)>& take) {
  const Accessor& a = at(accessor);
  const std::string where = fmt::format("accessors[{}]", accessor);
  if (a.shape != "SCALAR" || !is_unsigned(a.values.type)) refuse(where, "expected indices: SCALAR, of 8, 16 or 32 bits without a sign");
  read_elements(a, 1, where, [&](const std::array<double, 3>& n) { take(static_cast<uint64_t>(n[0])); });
}

void GltfFile::read_bytes(uint32_t buffer, uint64_t offset, std::span<char> out) {
  if (buffer >= buffers_.size()) refuse("bufferViews", fmt::format("expected the number of a buffer, found {} of {}", buffer, buffers_.size()));
  Buffer& b = buffers_[buffer];
  const bool first = !b.opened;
  if (first) open(buffer);
  const uint64_t there = b.beside ? b.beside->size() : b.uri.empty() ? binary_bytes_ : b.decoded.size();
  if (first && there < b.declared)
    refuse(fmt::format("buffers[{}]", buffer), fmt::format("cut short: expected {} bytes, found {}", b.declared, there));
  if (offset > there || out.size() > there - offset)
    refuse(fmt::format("buffers[{}]", buffer),
           fmt::format("cut short: expected {} bytes from {} on, found {} bytes in all", out.size(), offset, there));
  if (out.empty()) return;
  if (b.beside) b.beside->read(offset, out);
  else if (b.uri.empty()) contents_->read(binary_at_ + offset, out);
  else std::memcpy(out.data(), b.decoded.data() + offset, out.size());
}

void GltfFile::open(uint32_t buffer) {
  Buffer& b = buffers_[buffer];
  const std::string where = fmt::format("buffers[{}]", buffer);
  b.opened = true;
  if (b.uri.empty()) {
    if (binary_at_ == 0) refuse(where, "expected a file or data (uri), found none: the buffer is missing");
    all_bytes_ += binary_bytes_;
    return;
  }
  if (b.uri.starts_with("data:")) {
    constexpr std::string_view kCode = ";base64,";
    const size_t at = b.uri.find(kCode);
    if (at == std::string::npos) refuse(where, "expected data in base64");
    try {
      b.decoded = decoded_base64(std::string_view(b.uri).substr(at + kCode.size()));
    } catch (const InputError& e) {
      refuse(where, e.what());
    }
    b.uri = "data:";
    all_bytes_ += b.decoded.size();
    return;
  }
  const std::filesystem::path path = decoded_percent(b.uri);
  const bool outside = path.is_absolute() || b.uri.find(':') != std::string::npos || std::ranges::count(path, "..") > 0;
  if (outside) refuse(where, fmt::format("expected a file in the folder of this one, or below it, found {}", shown(b.uri)));
  if (!on_disk_) refuse(where, fmt::format("the file {} is missing", shown(b.uri)));
  const std::filesystem::path file = std::filesystem::path(name_).parent_path() / path;
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored) && !std::filesystem::is_regular_file(file, ignored))  // a pipe or a device may have no end
    refuse(where, fmt::format("expected a file, found something else at {}", shown(file.string())));
  try {
    Input beside(file);
    b.beside = std::make_unique<Contents>(beside, budget_);
    all_bytes_ += b.beside->size();
    if (b.beside->size() <= kSmallBuffer && small_bytes_ + b.beside->size() <= kSmallBuffers) {  // descriptors are few
      b.decoded.resize(b.beside->size());
      b.beside->read(0, b.decoded);
      b.beside.reset();
      b.uri = "data:";
      small_bytes_ += b.decoded.size();
    }
    file_.bytes += beside.bytes_on_disk();
    file_.hash += beside.hash();
  } catch (const IoError& e) {
    throw IoError(fmt::format("{}: {}: {}", name_, where, e.what()), e.number);
  }
}

}  // namespace teracell::mesher
