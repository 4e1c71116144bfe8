// All surface readers over any bytes: facets with coordinates within the limits and a few warnings, or an InputError;
// nothing else.
#include <cstdlib>

#include "mesher/surface/read_facets.hpp"
#include "mesher/surface/reader.hpp"
#include "store/base/error.hpp"
#include "store/text/text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace teracell;
  using namespace teracell::mesher;
  uint64_t seen = 0;
  try {
    Input input("fuzz", {reinterpret_cast<const char*>(data), size});
    const SurfaceFile file = read_facets(input, size % 4 == 3 ? "*a?" : "", [&](std::span<const Facet> facets) {
      seen += facets.size();
      for (const Facet& facet : facets)
        for (const Vec3& v : facet.vertex)
          for (const double x : v)
            if (!is_coordinate(x) || (x == 0 && std::signbit(x))) std::abort();
    });
    if (file.facets != seen || seen == 0 || file.bytes != size || file.warnings.size() > 3) std::abort();
    for (const std::string& w : file.warnings)
      if (w.size() < 10 || w.size() > 300 || w != printable(w)) std::abort();
  } catch (const InputError&) {
  }
  return 0;
}
