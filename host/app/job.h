// Job files on the command line: every option of a command under its long name, in TOML.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

namespace impactdic::app {

// Gives the options of `command` that the command line leaves out the values that the file has for
// them; those on the command line win. For a callback of --job: options are checked as if they had
// been typed. Throws FileError, InvalidArgument (no TOML, unknown key).
void apply_job(CLI::App& command, const std::string& file);

// Writes every option of `command` that was given or has a default to `path`, except those that
// say where results go and how they are shown. Paths become absolute. Throws FileError.
// For commands whose request has no list of settings (see run/settings.h).
void write_job(const CLI::App& command, const std::filesystem::path& path);

}  // namespace impactdic::app
