// The dashboard's page: its files are part of the program, or lie in a folder while somebody works on them. Only names that
// are in the list of these files are answered; everything else goes on to the routes, and is their 404.
//
// With a token the page is still for everybody: it holds no data, a browser sends no token when it opens an address, and
// the page then asks for the token and bears it in its own requests.
#pragma once
#include <filesystem>
#include <map>
#include <span>

#include "server/handler.hpp"

namespace teracell {

struct EmbeddedFile {
  std::string_view name;  // "index.html", "assets/main-Ab3.js"
  std::string_view gzip;
};
// What web/CMakeLists.txt has put into the program; empty when it was built without.
std::span<const EmbeddedFile> embedded_page();

// Threads share it.
class Page {
 public:
  Page() = default;  // there is none: "/" stays the routes' own
  explicit Page(std::span<const EmbeddedFile> files);
  // Files are looked for and read at each request. Throws IoError unless there is an index.html.
  explicit Page(std::filesystem::path folder);

  bool has(std::string_view path) const;
  // The answer when it is in memory as it will be sent.
  std::optional<Response> at_once(const Request& request) const;
  // None when the path is none of the page's. Throws IoError when a file can't be read.
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

// `inner`, with the page in front. REQUIRES: the page outlives it.
Handler with_page(Handler inner, const Page& page);

// `inner`, with a plain text at one path in front. It is for everybody, like the page.
Handler with_text(Handler inner, std::string path, Body text);

}  // namespace teracell
