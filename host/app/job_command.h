// What the commands that take a job file share: simulate, fit, compare.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace impactdic::app {

struct JobOptions {
  std::string job, output;
  int threads = 0;
  bool force = false, quiet = false;
};

struct JobCommand {
  const char* name;
  const char* description;
  const char* job_help;  // of the positional JOB
  const char* footer;
  bool threads = false;  // whether it has -j
};

// Adds the command; `run` gets the options once they are parsed.
void add_job_command(CLI::App& app, const JobCommand& command,
                     std::function<void(const JobOptions&)> run);

// One line each on stderr, also of a quiet run.
void print_warnings(const std::vector<std::string>& warnings, const std::string& about = "");

}  // namespace impactdic::app
