// Job files: every option of a command under its long name, in TOML. A run writes the job that it
// resolved, and `--job` reads it back.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace impactdic::app {

// The command line with the options of `--job FILE`, where it is given, put in before the
// command's own, so that those given on the command line win. `arguments` are those after the
// program's name. Throws FileError, FormatError (not TOML), InvalidArgument (unknown key).
std::vector<std::string> expand_job(const CLI::App& app, std::vector<std::string> arguments);

// Writes every option of `command` that was given or has a default to `path`, except those that
// say where results go and how they are shown. Paths become absolute. Throws FileError.
void write_job(const CLI::App& command, const std::filesystem::path& path);

// Throws InvalidArgument where an option of `command` differs from that in the job `path` of an
// earlier run, but for those that `may_differ`. Of the clip only the file's name counts. Throws
// FileError where there is no such job.
void require_same_job(const CLI::App& command, const std::filesystem::path& path,
                      const std::set<std::string>& may_differ);

}  // namespace impactdic::app
