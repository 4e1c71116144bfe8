#include "server/page/web.hpp"

#include <fstream>
#include <iterator>

#include <fmt/format.h>
#include <zlib.h>

#include "server/service/target.hpp"
#include "store/format/format.hpp"

namespace teracell::server {
namespace {

namespace fs = std::filesystem;

// Code, styles and data come from this server alone, so that a name from somebody's file can do no harm in the page. "blob:" is for
// what the page makes itself: workers of three.js, and pictures to be saved. "data:" is for small icons that the build puts into
// the style sheet. "wasm-unsafe-eval" lets the page compile its module (web/module), and no script. Frames are allowed: no button of
// the page changes anything, and notebooks show the page in a frame.
#define TERACELL_POLICY(connect)                                                                                                      \
  "Content-Security-Policy: default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; " \
  "font-src 'self'; connect-src " connect                                                                                             \
  "; worker-src 'self' blob:; manifest-src 'self'; base-uri 'none'; form-action 'none'\r\n"                                           \
  "Referrer-Policy: no-referrer\r\n"
constexpr const char* kMoreFields = TERACELL_POLICY("'self'");
// Of a page whose own address names grids of other hosts ("?grid=https://..."), and of the workers that read them.
constexpr const char* kFieldsOfReaders = TERACELL_POLICY("'self' https: http:");
#undef TERACELL_POLICY

const char* fields_for(std::string_view name, const Request& request) {
  const size_t query = request.target.find('?');
  const bool names_grids = query != std::string::npos && request.target.find("grid=", query) != std::string::npos;
  return name.starts_with("assets/worker-") || (name == "index.html" && names_grids) ? kFieldsOfReaders : kMoreFields;
}

const char* type_of(std::string_view name) {
  constexpr std::pair<std::string_view, const char*> types[] = {{".html", "text/html; charset=utf-8"},
                                                                {".js", "text/javascript; charset=utf-8"},
                                                                {".css", "text/css; charset=utf-8"},
                                                                {".json", "application/json"},
                                                                {".svg", "image/svg+xml"},
                                                                {".png", "image/png"},
                                                                {".ico", "image/x-icon"},
                                                                {".woff2", "font/woff2"},
                                                                {".wasm", "application/wasm"},
                                                                {".webmanifest", "application/manifest+json"}};
  for (const auto& [end, type] : types)
    if (name.ends_with(end)) return type;
  return "application/octet-stream";
}

// "" for a path that can't name a file of the page. Most requests are for data, and the folder must not be listed for each of them.
std::string_view name_of(std::string_view path) {
  if (path == "/") return "index.html";
  const bool on_top = path.find('/', 1) == path.npos && path.find('.') != path.npos;
  return on_top || path.starts_with("/assets/") ? path.substr(1) : "";
}

std::string hash_of(std::string_view bytes) {
  return fmt::format("{:016x}", checksum({reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size()}));
}

Response response(std::string_view name, const Request& request, std::string etag, bool forever) {
  return {.content_type = type_of(name),
          .etag = std::move(etag),
          .cache_control = forever ? "public, max-age=31536000, immutable" : "no-cache",
          .more_fields = fields_for(name, request),
          .route = "page"};
}

Response with_body(Response r, const Request& request, Body body) {
  if (has_etag(request.if_none_match, r.etag)) r.status = 304;
  else r.body = std::move(body);
  return r;
}

}  // namespace

std::string unpacked(const EmbeddedFile& file) {
  z_stream z{};
  if (inflateInit2(&z, MAX_WBITS + 16) != Z_OK) throw std::bad_alloc();
  z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(file.gzip.data()));
  z.avail_in = static_cast<uInt>(file.gzip.size());
  std::string out;
  char piece[16384];
  int status = Z_OK;
  while (status == Z_OK) {
    z.next_out = reinterpret_cast<Bytef*>(piece);
    z.avail_out = sizeof piece;
    status = inflate(&z, Z_NO_FLUSH);
    out.append(piece, sizeof piece - z.avail_out);
  }
  inflateEnd(&z);
  if (status != Z_STREAM_END) throw FormatError(fmt::format("{} of the page is damaged in the program: build the program again", file.name));
  return out;
}

Page::Page(std::span<const EmbeddedFile> files) {
  for (const EmbeddedFile& f : files) files_.emplace(f.name, File{body_of(std::string(f.gzip)), hash_of(f.gzip)});
}

Page::Page(fs::path folder) : folder_(std::move(folder)) {
  if (!has("/")) throw IoError(fmt::format("{}: expected a folder with the page that was built, found no index.html in it", folder_.string()));
}

// The files of the folder by their names: no part of a request ever becomes part of a file's path. Links and hidden files are left
// out.
Page::Listing Page::listing() const {
  Listing found;
  std::error_code error;
  for (fs::recursive_directory_iterator i(folder_, error), end; !error && i != end; i.increment(error)) {
    const bool hidden = i->path().filename().string().starts_with('.');
    if (hidden && i->is_directory(error)) i.disable_recursion_pending();
    if (!hidden && fs::is_regular_file(i->symlink_status(error))) found.emplace(i->path().lexically_relative(folder_).generic_string(), i->path());
  }
  return found;
}

bool Page::has(std::string_view path) const {
  const std::string_view name = name_of(path);
  if (name.empty()) return false;
  return folder_.empty() ? files_.contains(name) : listing().contains(name);
}

std::optional<Response> Page::at_once(const Request& request) const {
  const std::string_view name = name_of(path_of(request.target));
  const auto found = name.empty() || !request.accepts_gzip ? files_.end() : files_.find(name);
  if (found == files_.end()) return std::nullopt;
  Response r = response(name, request, fmt::format("\"{}-gz\"", found->second.etag), name.starts_with("assets/"));
  r.content_encoding = "gzip";
  return with_body(std::move(r), request, found->second.gzip);
}

std::optional<Response> Page::answer(const Request& request) const {
  if (std::optional<Response> r = at_once(request)) return r;
  const std::string_view name = name_of(path_of(request.target));
  if (name.empty()) return std::nullopt;
  if (const auto found = files_.find(name); found != files_.end())
    return with_body(response(name, request, fmt::format("\"{}\"", found->second.etag), name.starts_with("assets/")), request,
                     body_of(unpacked({name, *found->second.gzip})));
  if (folder_.empty()) return std::nullopt;
  const Listing there = listing();
  const auto found = there.find(name);
  if (found == there.end()) return std::nullopt;
  std::ifstream in(found->second, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  if (!in) throw IoError(fmt::format("{}: can't be read", name));
  Response r = response(name, request, fmt::format("\"{}\"", hash_of(text)), false);
  return with_body(std::move(r), request, body_of(std::move(text)));
}

Handler with_page(Handler inner, const Page& page) {
  return {[&page, at_once = std::move(inner.at_once)](const Request& request) {
            std::optional<Response> r = page.at_once(request);
            return r ? r : at_once(request);
          },
          [&page, handle = std::move(inner.handle)](const Request& request) {
            std::optional<Response> r = page.answer(request);
            return r ? *r : handle(request);
          },
          [&page, is_open = std::move(inner.is_open)](std::string_view path) { return page.has(path) || (is_open && is_open(path)); },
          std::move(inner.cost_of)};
}

Handler with_text(Handler inner, const std::string& path, const Body& text) {
  const Response whole{
      .content_type = "text/plain; charset=utf-8", .etag = fmt::format("\"{}\"", hash_of(*text)), .cache_control = "no-cache", .route = "page"};
  const auto answer = [=](const Request& request) -> std::optional<Response> {
    if (path_of(request.target) != path) return std::nullopt;
    return with_body(whole, request, text);
  };
  return {[answer, at_once = std::move(inner.at_once)](const Request& request) {
            std::optional<Response> r = answer(request);
            return r ? r : at_once(request);
          },
          [answer, handle = std::move(inner.handle)](const Request& request) {
            std::optional<Response> r = answer(request);
            return r ? *r : handle(request);
          },
          [path, is_open = std::move(inner.is_open)](std::string_view asked) { return asked == path || (is_open && is_open(asked)); },
          std::move(inner.cost_of)};
}

}  // namespace teracell::server
