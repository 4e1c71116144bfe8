// The dashboard's page. Its files are part of the program, or lie in a folder while somebody works on them. Only names in the
// list of these files are answered; all other requests go on to the routes.
//
// The page never needs a token. It holds no data, and a browser sends no token when it opens an address: the page asks for the
// token and sends it with its own requests.
#pragma once
#include <filesystem>
#include <map>
#include <span>

#include "server/service/handler.hpp"

namespace teracell::server {

struct EmbeddedFile {
  std::string_view name;  // "index.html", "assets/main-Ab3.js"
  std::string_view gzip;
};
// The files that web/CMakeLists.txt put into the program; empty when it was built without the page.
std::span<const EmbeddedFile> embedded_page();
// Throws FormatError for what is damaged.
std::string unpacked(const EmbeddedFile& file);

// Threads share it.
class Page {
 public:
  Page() = default;  // no page: the routes answer "/"
  explicit Page(std::span<const EmbeddedFile> files);
  // Looks for files and reads them at each request. Throws IoError unless there is an index.html.
  explicit Page(std::filesystem::path folder);

  bool has(std::string_view path) const;
  // The answer, if it is in memory in the form in which it will be sent.
  std::optional<Response> at_once(const Request& request) const;
  // The answer, if the path names a file of the page. Throws IoError when the file can't be read.
  std::optional<Response> answer(const Request& request) const;

 private:
  struct File {
    Body gzip;
    std::string etag;  // without its quotes
  };
  using Listing = std::map<std::string, std::filesystem::path, std::less<>>;
  Listing listing() const;
  std::map<std::string, File, std::less<>> files_;
  std::filesystem::path folder_;
};

// `inner`, behind the page. REQUIRES: the page outlives it.
Handler with_page(Handler inner, const Page& page);

// `inner`, behind a plain text at one path. Like the page, the text needs no token.
Handler with_text(Handler inner, const std::string& path, const Body& text);

}  // namespace teracell::server
