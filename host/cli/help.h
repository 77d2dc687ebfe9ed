// Help in groups: --help shows what is needed every day, --help-all everything.
#pragma once

#include <CLI/CLI.hpp>

namespace impactdic::cli {

// To be called before any command is added: they take over what is set here.
void show_help_in_groups(CLI::App& app);

// Puts the options of every command into their groups and has them take numbers with units and
// nothing but numbers; to be called when all commands are there.
void arrange(CLI::App& app);

}  // namespace impactdic::cli
