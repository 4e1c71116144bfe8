// The file of a grid as it is, read as it is taken.
#pragma once
#include <memory>

#include "server/service/message.hpp"
#include "store/base/file.hpp"

namespace teracell::server {

// REQUIRES: `file` outlives it.
std::unique_ptr<Parts> file_parts(const ByteSource& file);

}  // namespace teracell::server
