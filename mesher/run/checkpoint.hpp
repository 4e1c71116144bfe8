// What a killed run leaves behind so that another run can go on: the file "<output>.resume" beside "<output>.partial".
//
// It holds the state of the writers after some tile group, and what the run depends on: inputs, scene, options, versions. It
// is replaced now and then, each time after the partial file is durable up to that group. So the two files fit together
// whenever the process or the machine stops. (Rejected: journal frames inside the file. They would stay in it for good, and
// a resumed run would not end with the bytes of an undisturbed one.)
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "mesher/run/tile_group.hpp"
#include "store/base/bytes.hpp"

namespace teracell::mesher {

struct Checkpoint {
  std::string identity;  // JSON of all that the file's bytes depend on
  uint64_t groups = 0;   // tile groups that are finished, in the order of the tree
  CastTotals totals;
  Bytes writers;         // the state of the GridWriter, then that of the PyramidWriter
};

// The first thing in which two identities differ, in words.
std::string difference(const std::string& before, const std::string& now);

std::filesystem::path checkpoint_path(const std::filesystem::path& output);
// The checkpoint is durable when it returns.
void save_checkpoint(const Checkpoint& checkpoint, const std::filesystem::path& output);
// Returns nothing when there is nothing to resume. Throws InputError when the checkpoint is of another run, and says what has
// changed; FormatError when the checkpoint is damaged.
std::optional<Checkpoint> load_checkpoint(const std::filesystem::path& output, const std::string& identity);
void remove_checkpoint(const std::filesystem::path& output);

}  // namespace teracell::mesher
