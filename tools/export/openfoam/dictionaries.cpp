#include "tools/export/openfoam/dictionaries.hpp"

#include <fstream>
#include <utility>

#include <fmt/format.h>

#include "store/base/error.hpp"
#include "store/base/output_file.hpp"

namespace fs = std::filesystem;

namespace teracell::exports::foam {
namespace {

constexpr const char* kControl = R"(application     laplacianFoam;
startFrom       startTime;
startTime       0;
stopAt          endTime;
endTime         1;
deltaT          0.1;
writeControl    runTime;
writeInterval   1;
writeFormat     ascii;
writePrecision  12;
timePrecision   6;
)";

// Gradients and fluxes along the lines between cells' middles are exact: faces are at right angles to them.
constexpr const char* kSchemes = R"(ddtSchemes           { default Euler; }
gradSchemes          { default Gauss linear; }
divSchemes
{
    default          Gauss linear;
    div(phi,U)       Gauss linearUpwind grad(U);
    div(phi,T)       Gauss linearUpwind grad(T);
}
laplacianSchemes     { default Gauss linear orthogonal; }
interpolationSchemes { default linear; }
snGradSchemes        { default orthogonal; }
)";

// GAMG solves symmetric and other systems alike. The reference is for p and Phi where no patch gives them.
constexpr const char* kSolution = R"(solvers
{
    ".*" { solver GAMG; smoother GaussSeidel; tolerance 1e-10; relTol 0; }
}
SIMPLE        { nNonOrthogonalCorrectors 0; pRefCell 0; pRefValue 0; }
PISO          { nCorrectors 2; nNonOrthogonalCorrectors 0; pRefCell 0; pRefValue 0; }
potentialFlow { nNonOrthogonalCorrectors 0; PhiRefCell 0; PhiRefValue 0; }
)";

void write(const fs::path& file, const std::string& text) {
  const std::string whole = fmt::format(
      "FoamFile\n{{\n    version     2.0;\n    format      ascii;\n    class       dictionary;\n    location    \"system\";\n    object      {};\n}}\n\n{}",
      file.filename().string(), text);
  OutputFile out(file);
  out.append({reinterpret_cast<const uint8_t*>(whole.data()), whole.size()});
  out.commit();
}

// The number of parts that a decomposeParDict states, where that is written as usual.
std::optional<uint32_t> stated_parts(const fs::path& file) {
  std::ifstream in(file);
  for (std::string word; in >> word;)
    if (uint32_t parts; word == "numberOfSubdomains" && in >> parts) return parts;
  return std::nullopt;
}

}  // namespace

std::optional<uint32_t> other_parts(const fs::path& folder, uint32_t parts) {
  const auto stated = stated_parts(folder / "system" / "decomposeParDict");
  return stated == parts ? std::nullopt : stated;
}

std::vector<std::string> write_dictionaries(const fs::path& folder, std::optional<uint32_t> parts) {
  std::vector<std::pair<std::string, std::string>> all = {{"controlDict", kControl}, {"fvSchemes", kSchemes}, {"fvSolution", kSolution}};
  if (parts) all.emplace_back("decomposeParDict", fmt::format("numberOfSubdomains {};\nmethod             scotch;\n", *parts));
  std::vector<std::string> written;
  try {
    std::error_code error;
    fs::create_directories(folder / "system", error);
    if (error) throw IoError(fmt::format("{}: can't create: {}", (folder / "system").string(), error.message()));
    for (const auto& [name, text] : all) {
      const std::string within = "system/" + name;
      if (fs::exists(fs::symlink_status(folder / within, error))) continue;
      write(folder / within, text);
      written.push_back(within);
    }
  } catch (const IoError& e) {
    throw IoError(fmt::format("{} (the mesh is complete all the same)", e.what()));
  }
  return written;
}

}  // namespace teracell::exports::foam
