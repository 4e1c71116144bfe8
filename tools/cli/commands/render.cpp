// teracell render: a picture in three dimensions.
#include <map>

#include <fmt/format.h>

#include "server/render/encode.hpp"
#include "server/render/options.hpp"
#include "store/base/error.hpp"
#include "store/base/output_file.hpp"
#include "store/read/kept_chunks.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/progress.hpp"

namespace teracell::cli {
namespace {

constexpr size_t kChunksKept = size_t{64} << 20;  // bytes of decoded chunks

struct RenderArguments {
  GridArgument grid;
  std::string output, progress = "auto";
  std::map<std::string, std::string, std::less<>> words;  // of render_options()
  int threads = 0;
};

void run(const RenderArguments& o) {
  const std::string_view format = server::picture_format(o.output);
  if (format.empty()) throw UsageError(fmt::format("--output: expected a name that ends in .png, .jpg or .jpeg, found '{}'", o.output));
  check_output({o.grid.name}, o.output);
  const GridReader reader = open_grid(o.grid, std::make_shared<KeptChunks>(kChunksKept));
  const Wanted wanted = until_interrupted(o.output);
  const auto given = [&](std::string_view name) -> const std::string* {
    const auto it = o.words.find(name);
    return it == o.words.end() ? nullptr : &it->second;
  };
  const server::RenderOptions options = server::parse_render_options(given, reader, "--");
  OutputFile file(o.output);
  ProgressLine line(o.progress, "");
  const server::Picture3D picture = render(reader, options, threads_or_all(o.threads), [&](double share) { line("render", share); });
  const std::string bytes = encode_picture(picture, format);
  file.append({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()});
  file.commit();
}

}  // namespace

Run setup_render(CLI::App& app) {
  const auto o = std::make_shared<RenderArguments>();
  add_grid(app, o->grid);
  app.add_option("-o,--output", o->output, "the picture to write: .png, .jpg or .jpeg")->required();
  for (const server::RenderOption& option : server::render_options()) {
    const std::string name(option.name);
    add_word(app, "--" + name, std::string(option.value), std::string(option.help), [o, name](const std::string& text) { o->words[name] = text; });
  }
  add_threads(app, o->threads);
  add_progress(app, o->progress);
  app.footer(
      "Each pixel shows the first visible cell on its line of sight, exactly for the cells of the level that is drawn. Example:\n"
      "  teracell render g.tcell -o g.png --size 1920,1080 --cut y=0");
  return [o] { run(*o); };
}

}  // namespace teracell::cli
