// What a killed run leaves behind so that another can go on: "<output>.resume" beside "<output>.partial".
//
// The state of the writers after some tile group, and what the run depends on: inputs, scene, options, versions. It is
// replaced now and then, each time after the partial file's bytes up to there are durable; so whenever the process or
// the machine stops, the two fit together. (Rejected: journal frames inside the file. They would stay in it for good,
// and a resumed run would not end with the bytes of an undisturbed one.)
#pragma once
#include <filesystem>
#include <optional>
#include <string>

#include "mesher/tile_group.hpp"
#include "store/bytes.hpp"

namespace teracell {

struct Checkpoint {
  std::string identity;  // JSON: what the file's bytes depend on
  uint64_t groups = 0;    // finished, in the order of the tree
  CastTotals totals;
  Bytes writers;         // GridWriter's state, then PyramidWriter's
};

std::filesystem::path checkpoint_path(const std::filesystem::path& output);
// Durable when it returns.
void save_checkpoint(const Checkpoint& checkpoint, const std::filesystem::path& output);
// None when there is nothing to resume. InputError when the run was another one: it says what has changed. FormatError when
// the checkpoint is damaged.
std::optional<Checkpoint> load_checkpoint(const std::filesystem::path& output, const std::string& identity);
void remove_checkpoint(const std::filesystem::path& output);

}  // namespace teracell
