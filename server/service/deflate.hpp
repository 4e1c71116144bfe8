// Compresses with zlib: answers with gzip, and the chunks of Zarr.
#pragma once
#include <memory>
#include <string>
#include <string_view>

#include "server/service/message.hpp"

namespace teracell::server {

enum class Wrapping { kZlib, kGzip };
// Of any size, at level 1: labels come in long runs, and higher levels take several times as long to save a few per cent.
std::string deflated(std::string_view bytes, Wrapping wrapping);
// The parts as one stream of gzip, at the same level.
std::unique_ptr<Parts> gzip_parts(std::unique_ptr<Parts> parts);

}  // namespace teracell::server
