// The program without its page (TERACELL_WEB=OFF).
#include "server/web.hpp"

namespace teracell {

std::span<const EmbeddedFile> embedded_page() { return {}; }

}  // namespace teracell
