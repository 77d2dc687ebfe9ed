// What the commands that take a job file share: simulate, fit, compare.
#pragma once

#include <impactdic/control.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "host/app/command.h"
#include "sim/job/result_files.h"

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

// The parts of a command whose job asks for one run.
template <typename Request, typename Result>
struct JobRun {
  Request (*read)(const std::filesystem::path& job);
  Result (*run)(const Request&, const RunControl&);
  void (*write)(const std::filesystem::path& folder, const Request&, const Result&);
  std::string (*to_toml)(const Request&);  // what job.toml holds beside the results
  std::string (*in_words)(const Result&);
};

// Runs the job and writes results and job into the folder asked for.
template <typename Request, typename Result>
Result run_job(const JobOptions& options, const JobRun<Request, Result>& job) {
  Request request = job.read(options.job);
  request.threads = options.threads;
  Result result = job.run(request, {});
  const auto folder = prepare_output_directory(options.output, options.force);
  job.write(folder, request, result);
  sim::job::write_text(folder / "job.toml", job.to_toml(request));
  if (!options.quiet) std::fputs(job.in_words(result).c_str(), stdout);
  return result;
}

// One line each on stderr, also of a quiet run.
void print_warnings(const std::vector<std::string>& warnings, const std::string& about = "");

}  // namespace impactdic::app
