#pragma once
#include <string>
#include <vector>

#include "mesher/survey/survey.hpp"

namespace teracell::mesher {

// What `teracell info FILE... --json` prints for files without a grid.
std::string survey_json(const std::vector<FileSurvey>& files, const std::vector<std::string>& names);

}  // namespace teracell::mesher
