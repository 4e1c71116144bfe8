// What programs with commands do alike, from the words of the command line to the words of a failure.
#pragma once
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace teracell::cli {

void begin_program();  // first of all in main()
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names);
// This comes before CLI11 parses: it would complain about what is missing and never name the option that it doesn't know.
void refuse_unknown_options(const CLI::App& app, const std::vector<std::string>& words);
std::string explain(const CLI::ParseError& e, const CLI::App& app);  // what CLI11 found wrong, worded like the other errors

struct Failure {
  int status;
  std::string message;
};
Failure current_failure(const CLI::App& command);  // the exception that is being handled

}  // namespace teracell::cli
