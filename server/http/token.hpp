// The token that clients have to send, as its file holds it.
#pragma once
#include <filesystem>
#include <string>

namespace teracell::server {

// The first line of a file, without white space at its end. Throws IoError when the file can't be read or is a pipe or the like,
// UsageError unless the line is 1 to 4096 printable ASCII characters without spaces.
std::string read_token(const std::filesystem::path& file);

// Whether users besides the file's owner may read it.
bool others_can_read(const std::filesystem::path& file);

}  // namespace teracell::server
