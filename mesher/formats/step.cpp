// STEP (ISO 10303-21): products in a tree, made of exact solids. A CAD kernel, which is a program of its own, reads them and makes facets of
// them. The unit that is stated is found in the text: the kernel converts all that it reads into millimetres.
#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "mesher/cad/cad_model.hpp"
#include "mesher/cad/facets_file.hpp"
#include "mesher/formats/step_unit.hpp"
#include "mesher/surface/readers.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

constexpr std::string_view kFirstWord = "ISO-10303-21";

Match recognises_step(const Head& head) {
  const size_t start = head.bytes.find_first_not_of(" \t\r\n");
  return start != std::string_view::npos && head.bytes.substr(start).starts_with(kFirstWord) ? Match::kSure : Match::kNo;
}

std::string stated(const StepUnit& unit) { return unit.found().empty() ? kKernelUnit : unit.found(); }

std::vector<std::string> paths_of(const PartTree& tree) {
  std::vector<std::string> out;
  for (const Part& part : tree.parts()) out.push_back(part.path);
  return out;
}

std::string unit_of_step(Input& input) {
  StepUnit unit;
  for (std::string_view some; !(some = input.window(1)).empty() && unit.feed(some);) input.consume(some.size());
  return stated(unit);
}

// The first and the last bytes of a file, of which the kernel would not say what is wrong with them.
class Ends {
 public:
  void feed(std::string_view some) {
    first_ += some.substr(0, kByteOrderMark.size() - std::min(first_.size(), kByteOrderMark.size()));
    last_ += some.substr(some.size() - std::min(some.size(), kMost));
    if (last_.size() > kMost) last_.erase(0, last_.size() - kMost);
  }
  void check(const std::string& name) const {
    if (first_ == kByteOrderMark)
      throw InputError(fmt::format("{}: expected {} at the beginning, found a byte order mark before it, which STEP files don't have: take it away",
                                   name, kFirstWord));
    if (last_.find(kLastWord) == std::string::npos)
      throw InputError(fmt::format("{}: expected {} at the end, found none: the file is cut short", name, kLastWord));
  }

 private:
  static constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf", kLastWord = "END-ISO-10303-21";
  static constexpr size_t kMost = 4096;
  std::string first_, last_;
};

// A file, its tree, and the way from the kernel's unit to the one that is asked for.
class StepFile {
 public:
  StepFile(Input& input, SurfaceFile& file, const ReadOptions& options) : name_(input.name()), file_(file), cad_(*options.cad) {
    if (!input.regular())
      throw InputError(fmt::format("{}: expected a file, as the CAD kernel reads a STEP file more than once; found a pipe or a device", name_));
    StepUnit unit;
    Ends ends;
    model_.emplace(input, options.budget, cad_, [&](std::string_view some) { unit.feed(some), ends.feed(some); });
    ends.check(name_);
    file.format = "STEP";
    file.unit = stated(unit);
    if (unit.found().empty())
      file.warnings.push_back(
          fmt::format("it states no unit of length that has a name here (m, cm, mm, um, nm, in, ft): its lengths are in {}, as the CAD "
                      "kernel converts them",
                      kKernelUnit));
    file.factor = factor(file.unit, options.units);
    to_asked_for_ = factor(kKernelUnit, options.units.empty() ? file.unit : options.units);
  }

  // Shapes stand for facets that were not made.
  PartTree outline(const Budget& budget) {
    CadModel::Outline outline = model_->outline();
    Shapes shapes(budget);
    for (size_t i = 0; i < outline.shapes.size(); ++i) shapes.begin_shape(true);
    return tree_of(std::move(outline), std::move(shapes));
  }

  PartTree tree(const Budget& budget) {
    const double scale = to_asked_for_.value();
    const double deflection = std::max(kLeastDeflection, (cad_.deflection ? *cad_.deflection : usual_deflection(outline(budget))) / scale);
    CadModel::Outline outline = model_->outline();
    Shapes shapes(budget);
    file_.cad = std::make_shared<const CadFacts>(model_->add_facets(shapes, deflection, to_asked_for_, std::move(outline.shapes)));
    return tree_of(std::move(outline), std::move(shapes));
  }

  std::optional<std::array<Vec3, 2>> box(PartTree& tree, const std::vector<TakenParts>& taken) {
    std::vector<CadInstance> instances;
    for (const TakenParts& some : taken) {
      const std::vector<uint32_t> parts = tree.matching(PartGlob(some.glob));
      if (parts.empty()) refuse_no_match(name_, some.glob, paths_of(tree));
      for (const uint32_t i : parts) {
        const Part& part = tree.parts()[i];
        instances.push_back({*tree.node(part).shape, product(some.matrix, part.matrix)});
        for (const size_t m : {0, 1, 2, 4, 5, 6, 8, 9, 10}) instances.back().matrix[m] *= to_asked_for_.value();
      }
    }
    if (instances.empty()) return std::nullopt;
    return model_->box(instances);
  }

 private:
  double usual_deflection(PartTree tree) {
    const auto found = box(tree, {{"", kIdentity}});
    if (!found) return 1;
    const auto& [lo, hi] = *found;
    const double longest = std::max({hi[0] - lo[0], hi[1] - lo[1], hi[2] - lo[2]});
    return longest > 0 ? CadOptions::kOfBox * longest : 1;
  }

  PartTree tree_of(CadModel::Outline&& outline, Shapes&& shapes) const {
    const auto convert = [&](PartNode::Use& use) {
      for (const size_t t : {3, 7, 11}) use.matrix[t] = to_asked_for_.of(use.matrix[t]);
    };
    for (PartNode& node : outline.nodes) std::ranges::for_each(node.uses, convert);
    std::ranges::for_each(outline.roots, convert);
    return PartTree(name_, std::move(shapes), std::move(outline.nodes), outline.roots);
  }

  const std::string name_;
  SurfaceFile& file_;
  const CadOptions& cad_;
  Factor to_asked_for_;
  std::optional<CadModel> model_;
};

PartTree open_step(Input& input, SurfaceFile& file, const ReadOptions& options) { return StepFile(input, file, options).tree(options.budget); }

PartTree outline_of_step(Input& input, SurfaceFile& file, const ReadOptions& options) {
  return StepFile(input, file, options).outline(options.budget);
}

std::optional<std::array<Vec3, 2>> box_of_step(Input& input, const std::vector<TakenParts>& taken, const ReadOptions& options) {
  SurfaceFile file;
  StepFile step(input, file, options);
  PartTree tree = step.outline(options.budget);
  return step.box(tree, taken);
}

}  // namespace

const SurfaceReader kStepReader = {"STEP", recognises_step, nullptr, open_step, unit_of_step, {outline_of_step, box_of_step}};

}  // namespace teracell::mesher
