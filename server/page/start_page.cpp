#include "server/page/start_page.hpp"

#include <fmt/format.h>

#include "server/protocols/protocols.hpp"
#include "store/whole/info.hpp"

namespace teracell::server {
namespace {

// Names come from files, which anybody may have made.
std::string html(std::string_view text) {
  std::string out;
  for (const char c : text) switch (c) {
      case '&': out += "&amp;"; break;
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '"': out += "&quot;"; break;
      case '\'': out += "&#39;"; break;
      default: out += c;
    }
  return out;
}

// The finest level at which a slice across `axis` fits into a small picture.
int preview_level(const Grid& grid, int axis) {
  constexpr int64_t kMost = 480;
  const RayFrame f = RayFrame::along(axis);
  int level = 0;
  while (std::max(grid.cells(level)[f.u], grid.cells(level)[f.v]) > kMost) ++level;
  return level;
}

std::string card(const ServedGrid& grid, const Request& request) {
  const Index3 n = grid.meta().grid.cells();
  const std::string id = percent_encoded(grid.id), base = request.prefix, api = fmt::format("{}/api/v1/grids/{}", base, id);
  std::string pictures;
  for (const int axis : {2, 1, 0}) {
    const int level = preview_level(grid.meta().grid, axis);
    const int64_t index = n[axis] / 2;
    const std::string address = fmt::format("{}/slice/{}/{}.png?level={}&v={}", api, axis_name(axis), index >> level, level, grid.hash);
    pictures += fmt::format("<figure><img src=\"{}\" alt=\"slice across {}\"><figcaption>{} = {}</figcaption></figure>", html(address),
                            axis_name(axis), axis_name(axis), index);
  }
  std::string rows;
  const std::string root = request.origin + base;
  const auto row = [&](const char* name, const std::string& path) {
    rows += fmt::format("<tr><th>{}</th><td><a href=\"{}{}\">{}{}</a></td></tr>", name, html(base), html(path), html(root), html(path));
  };
  row("JSON", fmt::format("/api/v1/grids/{}", id));
  row("statistics", fmt::format("/api/v1/grids/{}/stats", id));
  for (const Protocol& p : protocols()) row(p.title, fmt::format("{}{}", address_of(p, grid), p.document));
  return fmt::format(
      "<section><h2>{}</h2><p>{} &times; {} &times; {} = {} cells in {:.1f} MB</p><div class=\"slices\">{}</div><table>{}</table></section>",
      html(grid.id), n[0], n[1], n[2], cell_count_text(n), static_cast<double>(grid.reader().file_bytes()) / 1e6, pictures, rows);
}

constexpr const char* kStyle =
    ":root{color-scheme:light dark}body{font:16px/1.5 system-ui,sans-serif;max-width:75rem;margin:2rem auto;padding:0 1rem}h1{font-weight:600}section{margin:2rem "
    "0;padding:1rem 1.5rem;border:1px solid #8884;border-radius:.5rem}h2{margin:.2rem 0}.slices{display:flex;flex-wrap:wrap;gap:1rem;margin:1rem 0}figure{margin:0}"
    "img{max-width:20rem;max-height:16rem;border:1px solid #8884;image-rendering:pixelated;background:#8882}figcaption{font-size:.85rem;opacity:.75}"
    "table{font-size:.9rem;border-collapse:collapse}th{text-align:left;font-weight:500;padding-right:1.5rem;white-space:nowrap}td{overflow-wrap:anywhere}";

}  // namespace

std::string start_page(Service& service, const Request& request) {
  std::string cards;
  for (const auto& grid : service.grids().all()) cards += card(*grid, request);
  for (const auto& [id, error] : service.grids().unreadable())
    cards += fmt::format("<section><h2>{}</h2><p>This file can't be read: {}</p></section>", html(id), html(error));
  if (cards.empty())
    cards = "<p>There is no grid here yet. Files that end in .tcell appear on this page soon after they are put into a folder that is served.</p>";
  return fmt::format(
      "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width\"><title>teracell</title><style>{}</style><h1>teracell</h1>{}"
      "<p><a href=\"{}/openapi.json\">description of the interface</a> &middot; <a href=\"{}/metrics\">metrics</a></p></html>",
      kStyle, cards, html(request.prefix), html(request.prefix));
}

}  // namespace teracell::server
