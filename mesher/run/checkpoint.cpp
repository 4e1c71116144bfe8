#include "mesher/run/checkpoint.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "store/base/error.hpp"
#include "store/base/file.hpp"
#include "store/base/output_file.hpp"
#include "store/format/format.hpp"
#include "store/text/json_text.hpp"

namespace teracell::mesher {
namespace {

constexpr char kMagic[] = "tcellruB";  // its last character is raised when the layout changes

}  // namespace

// An input's hash or size says most.
std::string difference(const std::string& before, const std::string& now) try {
  const nlohmann::json a = parse_json(before, "before"), b = parse_json(now, "now");
  const auto patch = nlohmann::json::diff(a, b);
  const std::string path = patch.empty() ? "" : patch.at(0).at("path");
  if (path.empty()) throw FormatError("it is in no value");
  const nlohmann::json::json_pointer at(path);
  const auto shown = [&](const nlohmann::json& j) { return j.contains(at) ? j.at(at).dump() : std::string("absent"); };
  return fmt::format("{} was {} and is {} now", path.substr(1), shown(a), shown(b));
} catch (const FormatError&) {
  return "its description is written in another way";
}

std::filesystem::path checkpoint_path(const std::filesystem::path& output) { return output.string() + ".resume"; }

void save_checkpoint(const Checkpoint& c, const std::filesystem::path& output) {
  Bytes out;
  out.insert(out.end(), kMagic, kMagic + 8);
  put_sized(out, c.identity);
  put_varint(out, c.groups);
  c.totals.save(out);
  put_sized(out, c.writers);
  put_fixed(out, checksum(out));
  OutputFile file(checkpoint_path(output));
  file.append(out);
  file.commit();
}

std::optional<Checkpoint> load_checkpoint(const std::filesystem::path& output, const std::string& identity) {
  const std::filesystem::path path = checkpoint_path(output);
  if (!std::filesystem::exists(path) || !std::filesystem::exists(output.string() + ".partial")) return std::nullopt;
  const InputFile file(path);
  Bytes bytes(file.size());
  file.read(0, bytes);
  const auto damaged = [&] { return FormatError(fmt::format("{}: damaged", path.string()), Remedy::kFreshStart); };
  if (bytes.size() < 16) throw damaged();
  const std::span<const uint8_t> body(bytes.data(), bytes.size() - 8);
  ByteReader end({bytes.data() + body.size(), 8}, path.string());
  if (end.fixed<uint64_t>() != checksum(body)) throw damaged();
  ByteReader in(body, path.string());
  const auto magic = in.take(8);
  if (!std::equal(magic.begin(), magic.end(), kMagic)) throw damaged();
  Checkpoint c;
  const auto text = in.take_sized();
  c.identity.assign(text.begin(), text.end());
  if (c.identity != identity)
    throw InputError(fmt::format("{}: can't resume: {}", output.string(), difference(c.identity, identity)), Remedy::kFreshStart);
  c.groups = in.varint();
  c.totals = CastTotals::restored(in);
  const auto writers = in.take_sized();
  c.writers.assign(writers.begin(), writers.end());
  in.expect_end();
  const uint64_t expected = ByteReader(writers, path.string()).fixed<uint64_t>(), found = std::filesystem::file_size(output.string() + ".partial");
  if (found < expected)
    throw FormatError(fmt::format("{}.partial: expected at least {} bytes to resume, found {}", output.string(), expected, found),
                      Remedy::kFreshStart);
  return c;
}

void remove_checkpoint(const std::filesystem::path& output) {
  std::error_code absent;  // is as good
  std::filesystem::remove(checkpoint_path(output), absent);
}

}  // namespace teracell::mesher
