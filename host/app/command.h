// What every command of the program shares. Each command lives in a file of its own,
// commands/NAME.cpp, and adds itself to the command line with add_NAME_command.
#pragma once

#include <impactdic/device.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <string>

#include "host/cli/checks.h"

namespace impactdic::app {

// Options that every command understands.
struct Common {
  SessionOptions session;
  bool quiet = false;
  int verbosity = 0;  // -v, -vv
  bool force = false;
};

// Adds --device, -j, -q, -v, --force, --job to a command. Every other option of the command can
// stand in the job file too, under its long name without the dashes (see job.h).
void add_common_options(CLI::App& command, Common& common);

// Of a command that reads clips: --sandbox, --no-sandbox.
void add_sandbox_option(CLI::App& command);

// Checks of an option's value.
using cli::non_negative_number;
using cli::positive_number;

// Makes DIR ready for results: creates it; refuses one that holds files unless `force`.
// Throws InvalidArgument or FileError.
std::filesystem::path prepare_output_directory(const std::string& dir, bool force);

// Each adds its command; main.cpp lists those that the program has.
void add_batch_command(CLI::App& app);
void add_bench_command(CLI::App& app);
void add_calibrate_command(CLI::App& app);
void add_devices_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_track_command(CLI::App& app);
void add_correlate_command(CLI::App& app);
void add_study_command(CLI::App& app);
void add_synth_command(CLI::App& app);
void add_simulate_command(CLI::App& app);
void add_fit_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_report_command(CLI::App& app);
void add_rod_command(CLI::App& app);
void add_tune_command(CLI::App& app);
void add_verify_command(CLI::App& app);
void add_view_command(CLI::App& app);

}  // namespace impactdic::app
