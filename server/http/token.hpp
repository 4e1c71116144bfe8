// The token that clients have to send, as its file holds it.
#pragma once
#include <filesystem>
#include <string>

namespace teracell {

// The first line of a file, without white space at its end. Throws IoError when the file can't be read, UsageError unless the
// line is 1 to 4096 printable ASCII characters without spaces.
std::string read_token(const std::filesystem::path& file);

}  // namespace teracell
