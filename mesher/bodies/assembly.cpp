#include "mesher/bodies/assembly.hpp"

#include <fmt/format.h>

#include "mesher/bodies/joining.hpp"
#include "store/base/error.hpp"

namespace teracell::mesher {
namespace {

class Placing : public Joining {
 public:
  using Joining::Joining;
  void bytes(uint64_t size) override {
    if (!places_.empty() && places_.back().to + places_.back().bytes == writer_.bytes()) places_.back().bytes += size;
    else places_.push_back({writer_.bytes(), size});
    writer_.skip(size);
  }
  std::vector<Placed> take_places() { return std::move(places_); }

 private:
  std::vector<Placed> places_;
};

}  // namespace

std::vector<Placed> Assembly::add(const PartReader& part) {
  Placing placing(writer_, pyramid_);
  part.replay(placing);
  return placing.take_places();
}

void copy_placed(const PartReader& part, const std::vector<Placed>& places, const FileRoom& file, const std::function<void()>& now_and_then) {
  constexpr uint64_t kBlock = 1 << 20;
  ContentHash hash;
  Bytes block;
  uint64_t from = 0;
  for (const Placed& place : places)
    for (uint64_t done = 0; done < place.bytes; done += block.size(), from += block.size()) {
      block.resize(std::min(kBlock, place.bytes - done));
      part.read(from, block);
      hash.add(block);
      file.write_at(place.to + done, block);
      now_and_then();
    }
  if (from != part.bytes() || hash.digest() != part.hash())
    throw FormatError(fmt::format("{}: damaged: expected other bytes, by their hash", part.name()));
}

}  // namespace teracell::mesher
