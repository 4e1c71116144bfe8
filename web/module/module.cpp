// The program without a server: what answers requests about grids, compiled to WebAssembly, for a worker of the page (web/src/module). A call
// never waits: where bytes of a file are missing it says so, the page fetches them, and calls again (page_file.hpp).
//
// The page writes what it has to say into room(); numbers that may be large are doubles, since JavaScript has these.
#include <optional>
#include <set>

#include "server/api/api.hpp"
#include "web/module/page_file.hpp"

#define EXPORTED extern "C" __attribute__((visibility("default"), used))

namespace teracell::server {
namespace {

constexpr size_t kCacheBytes = size_t{48} << 20;
constexpr uint64_t kMostPixels = uint64_t{1} << 24;
constexpr uint64_t kMostBody = uint64_t{512} << 20;

PageFiles files;
std::optional<Service> service;
std::vector<GridList::Entry> grids;  // that it serves
std::set<std::string> ids;           // of them
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
  if (!service) service.emplace(ServiceOptions{.cache_bytes = kCacheBytes, .max_pixels = kMostPixels}, std::make_unique<GridList>());
  return *service;
}

std::string_view stem_of(std::string_view name) {
  const size_t dot = name.rfind('.');
  return name.substr(0, dot == 0 ? name.npos : dot);
}

Response answer(const Request& request) {
  Service& all = all_grids();
  if (auto kept = all.from_cache(request)) return *kept;
  return answered(all, [&] {
    const Target target = parse_target(request.target);
    if (target.path[0] != "api") throw no_such_address(request);
    return answer_api(all, request, target, {});
  });
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

// Room for so many bytes; it is the same until the next call of room().
EXPORTED char* room(size_t bytes) {
  room_.resize(bytes);
  return room_.data();
}

// room() has a file's name. Returns its number. It is a grid of the list once it has been opened.
EXPORTED uint32_t add_file(double size) { return files.add(room_, static_cast<uint64_t>(size)); }

// Looks whether a file is a grid. When that is done, status() is 200 and body() has the grid's id, the stem of its name; or it is 400, and body()
// has what is wrong.
EXPORTED int open_file(uint32_t number) {
  return make([&] {
    try {
      Service& all = all_grids();
      const std::string id = grid_id(stem_of(files.file(number).name), ids);
      auto grid = served_grid(id, number, all.open(std::make_unique<PageFile>(files, number), number), all.fractions());
      ids.insert(id);
      grids.push_back({id, std::move(grid), ""});
      all.grids().publish(grids);
      response.status = 200;
      body = id;
    } catch (const Unwanted&) {
      throw;
    } catch (const std::exception& e) {
      response.status = 400;
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

}  // namespace teracell::server
