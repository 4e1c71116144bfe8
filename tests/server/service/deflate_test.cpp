// zlib itself reads back what was compressed.
#include "server/service/deflate.hpp"

#include "tests/support/served_cells.hpp"

namespace teracell::server {
namespace {

TEST_CASE("zlib reads back what was compressed, from nothing to noise, in both formats", "[server]") {
  std::mt19937 random(1);
  std::string noise(300000, '\0');
  for (char& c : noise) c = static_cast<char>(random());
  for (const Wrapping wrapping : {Wrapping::kZlib, Wrapping::kGzip})
    for (const std::string& text : {std::string(), std::string("a"), std::string(1000000, 'x'), noise}) {
      const std::string packed = deflated(text, wrapping);
      CHECK(static_cast<uint8_t>(packed.at(0)) == (wrapping == Wrapping::kGzip ? 0x1F : 0x78));
      CHECK(packed.capacity() <= packed.size() + 32);
      CHECK(testing::inflated(packed, text.size()) == text);
    }
}

}  // namespace
}  // namespace teracell::server
