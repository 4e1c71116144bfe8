// The options of a picture as people write them, on the command line and in addresses alike.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "server/render/render.hpp"

namespace teracell::server {

struct RenderOption {
  std::string_view name, value, help;  // without a value it is a flag
};
std::span<const RenderOption> render_options();

// The text of an option, or null when it is not given. That of a flag is "" or "1".
using OptionText = std::function<const std::string*(std::string_view name)>;

// Numbers in the text of an option. Errors call it by `dashes` and its name.
class OptionWords {
 public:
  explicit OptionWords(std::string_view dashes) : dashes_(dashes) {}
  std::string_view dashes() const { return dashes_; }
  [[noreturn]] void refuse(std::string_view name, std::string_view expected, std::string_view found) const;
  double number(std::string_view name, std::string_view text, const char* expected) const;  // at most 1e75: no grid has larger coordinates
  Vec3 point(std::string_view name, const std::string& text) const;

 private:
  std::string_view dashes_;
};

// Throws UsageError, which calls an option by `dashes` and its name.
RenderOptions parse_render_options(const OptionText& text, const GridReader& reader, std::string_view dashes);

}  // namespace teracell::server
