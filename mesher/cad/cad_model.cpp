#include "mesher/cad/cad_model.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/cad/facets_file.hpp"
#include "mesher/cad/idle_kernels.hpp"
#include "mesher/cad/kernel_facets.hpp"
#include "store/base/bytes.hpp"
#include "store/base/error.hpp"
#include "store/format/format.hpp"
#include "store/text/json_node.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

std::span<const uint8_t> bytes_of(std::string_view text) { return {reinterpret_cast<const uint8_t*>(text.data()), text.size()}; }

// By the time of the last change of any kind, which nobody can put back as they can that of the contents.
FileState state_now(const Descriptor& file) {
  struct stat s;
  if (::fstat(file.get(), &s) != 0) return {};
  FileState out = state_of(s);
  out.changed = int64_t{s.st_ctim.tv_sec} * 1'000'000'000 + s.st_ctim.tv_nsec;
  return out;
}

// An open file with the input's bytes as the kernel wants them: the file itself, or a temporary one without a name.
Descriptor plain(Input& input, const Budget& budget, const std::function<void(std::string_view)>& each, FileState& state) {
  Descriptor file = input.plain_file();
  if (!file) {
    std::string name = (budget.folder / "teracell-XXXXXX.step").string();
    file = Descriptor(::mkostemps(name.data(), 5, O_CLOEXEC));
    if (!file) fail_at(name, "can't create", errno);
    ::unlink(name.c_str());
  }
  const bool copies = !input.plain_file();
  if (!copies) state = state_now(file);
  for (std::string_view some; !(some = input.window(1)).empty(); input.consume(some.size())) {
    each(some);
    if (copies && !file.append(bytes_of(some))) fail_at(budget.folder, "can't write a temporary file", errno);
  }
  return file;
}

Matrix matrix_in(const JsonNode& use, const std::string& name) {
  Matrix out = use.require("matrix").numbers<12>();
  for (double& m : out) m = checked_coordinate(std::abs(m) < 1e-75 ? 0 : m, name + ": a matrix");
  return out;
}

PartNode::Use use_in(const JsonNode& use, size_t nodes, const std::string& name) {
  return {static_cast<uint32_t>(use.require("node").whole(nodes - 1)), matrix_in(use, name), use.require("name").any_text()};
}

}  // namespace

CadModel::CadModel(Input& input, const Budget& budget, const CadOptions& options, const std::function<void(std::string_view)>& each)
    : name_(input.name()),
      options_(options),
      cache_(options.cache, budget),
      file_(plain(input, budget, each, state_)),
      program_(kernel_program(name_)),
      file_hash_(input.hash()) {
  version_ = find_version();
}

// To start the program takes a twentieth of a second, so what it says is kept as long as it is the same file.
std::string CadModel::find_version() {
  struct stat s;
  if (::stat(program_.c_str(), &s) != 0) fail_at(program_, "can't read", errno);
  const std::string identity =
      fmt::format("{}\n{}\n{}\n{}\n{}.{}", kFacetsMagic, program_.string(), s.st_ino, s.st_size, s.st_mtim.tv_sec, s.st_mtim.tv_nsec);
  ContentHash hash;
  hash.add(bytes_of(identity));
  const std::string k = hex(hash.digest());
  if (auto known = cache_.find_text(k)) return *known;
  start();
  const std::string text = kernel_->ask("", "kernel", options_);
  std::string version = naming(name_, [&] {
    const Json json = parse_json(text, "the CAD kernel's name");
    const JsonNode root(json, "the CAD kernel's name");
    return root.require("kernel").text();
  });
  cache_.add_text(k, version);
  return version;
}

void CadModel::start() { kernel_ = std::make_unique<KernelProcess>(program_, name_, file_, options_); }

CadModel::~CadModel() {
  if (options_.kernels && kernel_ && read_ && kernel_->is_idle()) options_.kernels->add(file_hash_, std::move(kernel_));
}

std::string CadModel::key(const std::string& what) const {
  ContentHash hash;
  hash.add(bytes_of(fmt::format("{}\n{}\n{}\n{}", kFacetsMagic, version_, file_hash_, what)));
  return hex(hash.digest());
}

// Whoever holds it makes what is missing, for as long as the kernel may take. After that it is made here as well, which is no harm.
Descriptor CadModel::lock(const std::string& what) const {
  return cache_.lock(what, options_.seconds, [&] { options_.waiting(0); });
}

KernelProcess& CadModel::kernel() {
  if (!kernel_ && options_.kernels) {
    kernel_ = options_.kernels->take(file_hash_);
    read_ = kernel_ != nullptr;
  }
  if (kernel_ && !kernel_->is_idle()) kernel_.reset(), read_ = false;
  if (!kernel_) start();
  if (!read_) read();
  return *kernel_;
}

// The kernel reads the file after it was hashed here.
void CadModel::expect_unchanged() const {
  if (state_ != FileState{} && state_now(file_) != state_) throw InputError(fmt::format("{}: the file changed while it was read", name_));
}

CadModel::Outline CadModel::outline() {
  if (!outline_.empty()) return outline_in(outline_);
  const std::string k = key("outline");
  Descriptor held;
  std::optional<std::string> text = cache_.find_text(k);
  if (!text) {
    held = lock(k);
    text = cache_.find_text(k);
  }
  if (text) {
    Outline out = outline_in(*text);
    outline_ = std::move(*text);
    return out;
  }
  if (!kernel_) start();
  read();
  Outline out = outline_in(outline_);
  cache_.add_text(k, outline_);
  return out;
}

// The kernel says what the file holds once, when it has read it.
void CadModel::read() {
  outline_ = kernel_->ask("", "outline", options_);
  read_ = true;
  expect_unchanged();
}

CadModel::Outline CadModel::outline_in(const std::string& text) const {
  return naming(name_, [&] {
    const Json json = parse_json(text, "the CAD kernel's outline");
    const JsonNode root(json, "the CAD kernel's outline");
    const JsonNode outline = root.require("outline");
    Outline out;
    outline.each("shapes", [&](const JsonNode& s) {
      CadShape& shape = out.shapes.emplace_back();
      shape.faces = s.require("faces").whole();
      shape.sender_volume = s.number_or_null("sender_volume");
    });
    const JsonNode node_list = outline.require("nodes");
    const std::vector<JsonNode> nodes = node_list.items();
    if (out.shapes.empty() || nodes.empty()) outline.fail("shapes and nodes");
    for (const JsonNode& n : nodes) {
      PartNode& node = out.nodes.emplace_back();
      node.name = utf8_of(n.require("name").any_text());
      node.product = utf8_of(n.require("product").any_text());
      node.color = n.require("color").any_text();
      node.material = utf8_of(n.require("material").any_text());
      if (const JsonNode shape = n.require("shape"); !shape.is_null()) node.shape = static_cast<uint32_t>(shape.whole(out.shapes.size() - 1));
      n.each("uses", [&](const JsonNode& u) { node.uses.push_back(use_in(u, nodes.size(), name_)); });
    }
    outline.each("roots", [&](const JsonNode& u) { out.roots.push_back(use_in(u, nodes.size(), name_)); });
    return out;
  });
}

std::array<Vec3, 2> CadModel::box(const std::vector<CadInstance>& instances) {
  std::string command = fmt::format("box {}\n", instances.size());
  for (const CadInstance& i : instances) command += fmt::format("{} {}\n", i.shape, fmt::join(i.matrix, " "));
  const std::string k = key(command);
  std::optional<std::string> known = cache_.find_text(k);
  Descriptor held;
  if (!known) {
    held = lock(k);
    known = cache_.find_text(k);
  }
  const std::string text = known ? *known : kernel().ask(command, "box", options_);
  const auto out = naming(name_, [&] {
    const Json json = parse_json(text, "the CAD kernel's box");
    const JsonNode root(json, "the CAD kernel's box");
    auto b = root.require("box").numbers<6>();
    for (double& v : b) v = std::abs(v) < 1e-75 ? 0 : v;
    for (const double v : b)
      if (!(std::abs(v) <= 1e75)) throw InputError(fmt::format("{}: the CAD kernel finds surfaces without bounds in it", name_));
    return std::array{Vec3{b[0], b[1], b[2]}, Vec3{b[3], b[4], b[5]}};
  });
  if (!known) cache_.add_text(k, text);
  return out;
}

CadFacts CadModel::add_facets(Shapes& shapes, double deflection, const Factor& factor, std::vector<CadShape> facts) {
  CadFacts out{version_,        key(fmt::format("facets {} {}", deflection, options_.angle)), "", deflection * factor.value(), options_.angle,
               std::move(facts)};
  const auto make = [&](const std::string& path) {
    if (path.find('\n') != std::string::npos)
      throw IoError(fmt::format("{}: {}: expected a folder without a line break in its name", name_, path), Remedy::kOtherFolder);
    const int threads = options_.threads > 0 ? options_.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    kernel().ask(fmt::format("facets {} {} {} {}\n", deflection, options_.angle, threads, std::filesystem::absolute(path).string()), "done",
                 options_);
  };
  std::optional<FacetCache::Entry> entry = cache_.find(out.key);
  if (!entry) {
    const Descriptor held = lock(out.key);
    entry = cache_.find(out.key);
    if (!entry) entry = cache_.add(out.key, make);
  }
  out.hash = entry->hash;
  naming(name_, [&] { read_kernel_facets(entry->file, entry->size, name_, factor, shapes, out.shapes); });
  return out;
}

}  // namespace teracell::mesher
