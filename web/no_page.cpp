// The program without its page (TERACELL_WEB=OFF).
#include "server/page/web.hpp"

namespace teracell::server {

std::span<const server::EmbeddedFile> embedded_page() { return {}; }

}  // namespace teracell::server
