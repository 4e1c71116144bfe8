// The exceptions of teracell. A message says what is wrong and where, what was expected, what was found and, if there is
// one, the way out. Libraries only throw. main() turns a type into an exit status, and routes turn it into an HTTP status.
#pragma once
#include <stdexcept>
#include <string>

namespace teracell {

struct Error : std::runtime_error {
  using std::runtime_error::runtime_error;
};
struct IoError : Error {  // the operating system reports a failure
  using Error::Error;
};
struct FormatError : Error {  // a .tcell file breaks FORMAT.md
  using Error::Error;
};
struct InputError : Error {  // a surface or a data file can't be used
  using Error::Error;
};
struct UsageError : Error {  // an option, a scene key or an index is wrong
  using Error::Error;
};
struct Interrupted : Error {  // the user asked to stop
  using Error::Error;
};

}  // namespace teracell
