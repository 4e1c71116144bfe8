// The program without a server: what answers requests about grids, compiled to WebAssembly, for a worker of the page (web/src/module). A call
// never waits: where bytes of a file are missing it says so, the page fetches them, and calls again (page_file.hpp).
//
// The page writes what it has to say into room(); numbers that may be large are doubles, since JavaScript has these.
#include <optional>

#include "server/api.hpp"
#include "store/json_text.hpp"
#include "store/sources.hpp"
#include "web/module/page_file.hpp"

#define EXPORTED extern "C" __attribute__((visibility("default"), used))

namespace teracell {
namespace {

constexpr size_t kCacheBytes = size_t{48} << 20;
constexpr uint64_t kMostPixels = uint64_t{1} << 24;
constexpr uint64_t kMostBody = uint64_t{512} << 20;
constexpr std::string_view kScheme = "page://";

PageFiles files;
std::vector<std::filesystem::path> named;  // of the files that are grids
std::optional<Service> service;            // of all of them
std::string room_;
std::vector<PageFiles::Missing> wanted;
Response response;
std::string body;  // of the response

// What a call returns.
enum Outcome { kDone = 0, kLater = 1 };

template <class F>
Outcome make(F&& f) {
  try {
    f();
    return kDone;
  } catch (const Later&) {
    wanted = files.take_missing();
    return kLater;
  }
}

Service& all_grids() {
  if (!service) service.emplace(ServiceOptions{.named = named, .cache_bytes = kCacheBytes, .max_pixels = kMostPixels});
  return *service;
}

Response answer(const Request& request) {
  try {
    Service& grids = all_grids();
    if (auto kept = grids.from_cache(request)) return *kept;
    return answered(grids, [&] {
      const Target target = parse_target(request.target);
      if (target.path[0] != "api") throw no_such_address(request);
      return answer_api(grids, request, target, {});
    });
  } catch (const FormatError& e) {
    return error_response(500, "damaged", e.what());
  }
}

// An answer in parts is put together, since each may want bytes.
std::string whole(const Response& r) {
  std::string out = r.body ? *r.body : "";
  if (!r.rest) return out;
  while (r.rest->append(out))
    if (out.size() > kMostBody) throw OptionError("the answer is larger than a page may hold: ask for less, or use the program teracell");
  return out;
}

}  // namespace

// Of "page://3/bust.tcell".
std::unique_ptr<ByteSource> open_source(const std::string& name, const SourceOptions&) {
  return std::make_unique<PageFile>(files, static_cast<uint32_t>(std::stoul(name.substr(kScheme.size()))));
}
bool is_address(std::string_view name) { return name.starts_with(kScheme); }

// Room for so many bytes; it is the same until the next call of room().
EXPORTED char* room(size_t bytes) {
  room_.resize(bytes);
  return room_.data();
}

// room() has a file's name. Returns its number. It is a grid of the list once it has been opened.
EXPORTED uint32_t add_file(double size) { return files.add(room_, static_cast<uint64_t>(size)); }

// Looks whether a file is a grid. When that is done, body() has what is wrong, or nothing. Ids of grids are the stems of names.
EXPORTED int open_file(uint32_t number) {
  return make([&] {
    body.clear();
    try {
      const GridReader reader(std::make_unique<PageFile>(files, number));
      named.push_back(std::string(kScheme) + std::to_string(number) + "/" + files.file(number).name);
      service.reset();
    } catch (const Unwanted&) {
      throw;
    } catch (const std::exception& e) {
      body = e.what();
    }
  });
}

// room() has the target of a request.
EXPORTED int answer() {
  return make([] {
    response = answer(Request{.target = room_});
    try {
      body = whole(response);
    } catch (const Unwanted&) {
      throw;
    } catch (const std::exception& e) {
      response = error_response(400, "bad_request", e.what());
      body = *response.body;
    }
    response.rest = nullptr;
    response.body = nullptr;
  });
}

EXPORTED int status() { return response.status; }
EXPORTED const char* content_type() { return response.content_type.c_str(); }
EXPORTED const char* etag() { return response.etag.c_str(); }
EXPORTED const char* body_data() { return body.data(); }
EXPORTED size_t body_size() { return body.size(); }
// What kLater means: which bytes of which files.
EXPORTED size_t missing_count() { return wanted.size(); }
EXPORTED uint32_t missing_file(size_t i) { return wanted[i].file; }
EXPORTED double missing_offset(size_t i) { return static_cast<double>(wanted[i].offset); }
EXPORTED double missing_size(size_t i) { return static_cast<double>(wanted[i].size); }
// Nobody waits for bytes: those that were not used for long may go.
EXPORTED void rest() { files.rest(); }
// room() has bytes of a file.
EXPORTED void give(uint32_t file, double offset) {
  files.give(file, static_cast<uint64_t>(offset), {reinterpret_cast<const uint8_t*>(room_.data()), room_.size()});
}

}  // namespace teracell
