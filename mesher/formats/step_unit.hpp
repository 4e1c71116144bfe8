// The unit of length that a STEP file states, found in its text.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace teracell::mesher {

class StepUnit {
 public:
  // Takes the next bytes of the file. Returns whether more are wanted: contexts and units may stand anywhere.
  bool feed(std::string_view text);
  // That of the first context of three dimensions, else of the first one: m, cm, mm, um, nm, in or ft. Empty: another one, or none is stated.
  const std::string& found() const { return found_; }

 private:
  void end_instance();
  enum class In { kText, kQuotes, kComment } in_ = In::kText;
  bool keeps_ = false;  // what stands in these quotes: only the name of a unit is wanted
  char before_ = 0;
  std::string instance_;  // "#12=(LENGTH_UNIT()..." without blanks: its first bytes
  std::unordered_map<uint64_t, std::string> units_;  // of length, by the number of their instance
  std::vector<uint64_t> context_;                    // the units of the context that counts so far
  bool in_space_ = false;                            // it has three dimensions
  std::string found_;
  bool done_ = false;
};

}  // namespace teracell::mesher
