// The formats that cells can be exported to.
#pragma once
#include "tools/export/format.hpp"

namespace teracell::exports {

const std::vector<ExportFormat>& export_formats();
// nullptr when there is none.
const ExportFormat* export_format_named(const std::string& name);
const ExportFormat* export_format_of(const std::filesystem::path& output);  // by its extension

}  // namespace teracell::exports
