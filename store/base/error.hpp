// The exceptions of teracell. A message says what is wrong and where, what was expected, what was found and, if there is
// one, the way out. Libraries only throw. main() turns a type into an exit status, and routes turn it into an HTTP status.
#pragma once
#include <stdexcept>
#include <string>

namespace teracell::inline store {

// What the caller could change so that the work succeeds. Libraries know no command line, so it is the caller who says how.
enum class Remedy {
  kNone,
  kCellsOrStep,  // to say how many cells there are, or how large they are
  kMoreMemory,
  kOtherFolder,  // for temporary files
  kOtherFolderOrMoreMemory,
  kFreshStart,  // instead of resuming
  kAllowHttp,   // for an address without TLS
  kCadMemory,
  kCadTime,
};

struct Error : std::runtime_error {
  explicit Error(const std::string& message, Remedy what_helps = Remedy::kNone) : std::runtime_error(message), remedy(what_helps) {}
  Remedy remedy;
};
struct IoError : Error {  // the operating system reports a failure
  using Error::Error;
  IoError(const std::string& message, int error) : Error(message), number(error) {}
  int number = 0;  // its errno, where that is known
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
struct OptionError : UsageError {  // an option of a library is wrong: the message begins with the field's name and a colon
  using UsageError::UsageError;
};
struct Interrupted : Error {  // the user asked to stop
  using Error::Error;
};

// Calls f(). A FormatError that does not begin with the name of the file is thrown again with it.
template <class F>
auto naming(const std::string& file, F&& f) try {
  return f();
} catch (const FormatError& e) {
  const std::string message = e.what();
  if (message.starts_with(file + ':')) throw;
  throw FormatError(file + ": " + message, e.remedy);
}

}  // namespace teracell::store
