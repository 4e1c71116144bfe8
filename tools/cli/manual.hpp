// Manual pages and completions for shells, from the same tables as the help.
#pragma once
#include <filesystem>

#include <CLI/CLI.hpp>

namespace teracell::cli {

// Writes DIR/man1/teracell.1 and a page for each command, DIR/bash/teracell, DIR/zsh/_teracell and DIR/fish/teracell.fish.
void write_manual(const CLI::App& app, const std::filesystem::path& folder);

}  // namespace teracell::cli
