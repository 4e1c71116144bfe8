#include "mesher/cad/cad_model.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <list>
#include <mutex>
#include <thread>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "mesher/cad/facets_file.hpp"
#include "mesher/cad/kernel_process.hpp"
#include "store/base/bytes.hpp"
#include "store/base/error.hpp"
#include "store/format/format.hpp"
#include "store/text/json_node.hpp"
#include "store/text/text.hpp"

namespace teracell::mesher {
namespace {

// Kernels that have read a file and wait, by its hash: a run looks at a file's tree first, then at its box, then at its facets, from different
// places. Threads share it.
class IdleKernels {
 public:
  std::unique_ptr<KernelProcess> take(const std::string& file) {
    std::lock_guard lock(mutex_);
    const auto found = std::ranges::find(list_, file, &Idle::first);
    if (found == list_.end()) return nullptr;
    std::unique_ptr<KernelProcess> out = std::move(found->second);
    list_.erase(found);
    return out;
  }
  void add(const std::string& file, std::unique_ptr<KernelProcess> kernel) {
    constexpr size_t kMost = 4;
    std::lock_guard lock(mutex_);
    list_.emplace_front(file, std::move(kernel));
    if (list_.size() > kMost) list_.pop_back();
  }
  void clear() {
    std::lock_guard lock(mutex_);
    list_.clear();
  }

 private:
  using Idle = std::pair<std::string, std::unique_ptr<KernelProcess>>;
  std::mutex mutex_;
  std::list<Idle> list_;
};

IdleKernels& idle_kernels() {
  static IdleKernels kernels;
  return kernels;
}

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

// The bytes of an entry from front to back.
class EntryReader {
 public:
  EntryReader(const FacetCache::Entry& entry, std::string name) : entry_(entry), name_(std::move(name)) {}
  void read(void* to, size_t bytes) {
    auto* out = static_cast<uint8_t*>(to);
    while (bytes > 0) {
      if (used_ == block_.size()) refill();
      const size_t some = std::min(bytes, block_.size() - used_);
      std::memcpy(out, block_.data() + used_, some);
      out += some, used_ += some, bytes -= some;
    }
  }
  uint64_t left() const { return entry_.size - at_ + (block_.size() - used_); }
  [[noreturn]] void fail(const std::string& what) const { throw FormatError(fmt::format("{}: the CAD kernel's facets: {}", name_, what)); }

 private:
  void refill() {
    if (at_ == entry_.size) fail("too short");
    block_.resize(std::min<uint64_t>(entry_.size - at_, 1 << 18));
    if (entry_.file.read(at_, block_) < block_.size()) fail("can't be read");
    at_ += block_.size();
    used_ = 0;
  }
  const FacetCache::Entry& entry_;
  const std::string name_;
  Bytes block_;
  size_t used_ = 0;
  uint64_t at_ = 0;
};

double cubed(double v) { return v * v * v; }

// What the kernel rounded to nearly nothing is 0: only a user's own coordinates are refused for that.
Vec3 vertex_in(EntryReader& in) {
  Vec3 v;
  in.read(v.data(), sizeof v);
  for (double& x : v)
    if (!is_coordinate(x)) x = std::abs(x) < 1e-75 ? 0 : checked_coordinate(x, "a vertex of the CAD kernel");
  for (double& x : v) x += 0.0;
  return v;
}

}  // namespace

void end_idle_kernels() { idle_kernels().clear(); }

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
  if (kernel_ && read_ && kernel_->is_idle()) idle_kernels().add(file_hash_, std::move(kernel_));
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
  if (!kernel_) {
    kernel_ = idle_kernels().take(file_hash_);
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
    const auto b = root.require("box").numbers<6>();
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
  naming(name_, [&] { read_facets_of(*entry, shapes, factor, out); });
  return out;
}

void CadModel::read_facets_of(const FacetCache::Entry& entry, Shapes& shapes, const Factor& factor, CadFacts& out) const {
  EntryReader in(entry, name_);
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
  const std::vector<JsonNode> list = shape_list.items(out.shapes.size());
  const double volume = cubed(factor.value());
  for (size_t i = 0; i < list.size(); ++i) {
    const JsonNode& s = list[i];
    CadShape& shape = out.shapes[i];
    shape.faces_without_facets = s.require("faces_without_facets").whole();
    shape.closed = s.require("closed").boolean();
    shape.facet_volume = s.require("facet_volume").number() * volume;
    shape.facet_area = s.require("facet_area").number() * factor.value() * factor.value();
    shape.kernel_volume = s.number_or_null("kernel_volume");
    for (std::optional<double>* v : {&shape.kernel_volume, &shape.sender_volume})
      if (*v) **v *= volume;
    const uint64_t vertices = s.require("vertices").whole(in.left() / sizeof(Vec3));
    const uint32_t set = shapes.begin_vertices(false);
    for (uint64_t v = 0; v < vertices; ++v) shapes.add_vertex(vertex_in(in), factor, name_);
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
