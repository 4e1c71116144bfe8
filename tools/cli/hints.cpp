#include "tools/cli/hints.hpp"

#include <algorithm>

namespace teracell::cli {
namespace {

const char* hint(Remedy remedy) {
  switch (remedy) {
    case Remedy::kNone: return "";
    case Remedy::kCellsOrStep: return ": give --cells N, --cells NX,NY,NZ or --step H, or \"cells\" or \"step\" in the scene's grid";
    case Remedy::kMoreMemory: return ": allow more with --memory";
    case Remedy::kOtherFolder: return ": give another folder with --tmp or TMPDIR";
    case Remedy::kOtherFolderOrMoreMemory: return ": give another folder with --tmp, or more --memory";
    case Remedy::kFreshStart: return ": start again without --resume";
    case Remedy::kCadMemory: return ": allow more with --cad-memory";
    case Remedy::kCadTime: return ": allow more with --cad-seconds";
    case Remedy::kAllowHttp: return ": give --allow-http if this is what you want";
  }
  return "";
}

}  // namespace

std::string with_hint(const Error& e) {
  std::string text = e.what();
  if (dynamic_cast<const OptionError*>(&e) != nullptr) {
    const auto name_end = text.begin() + static_cast<std::ptrdiff_t>(std::min(text.find(':'), text.size()));
    std::replace(text.begin(), name_end, '_', '-');
    text.insert(0, "--");
  }
  return text + hint(e.remedy);
}

}  // namespace teracell::cli
