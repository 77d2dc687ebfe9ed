#include "host/app/job_command.h"

#include <cstdio>
#include <memory>

namespace impactdic::app {

void add_job_command(CLI::App& app, const JobCommand& command,
                     std::function<void(const JobOptions&)> run) {
  CLI::App* added = app.add_subcommand(command.name, command.description);
  auto options = std::make_shared<JobOptions>();
  added->add_option("JOB", options->job, command.job_help)->required();
  added->add_option("-o,--output", options->output, "Folder for the results")->required();
  if (command.threads) {
    added->add_option("-j,--threads", options->threads, "Shots at a time; 0 takes all cores")
        ->check(CLI::Range(0, 1024))
        ->capture_default_str();
  }
  added->add_flag("--force", options->force, "Write into a folder that already holds files");
  added->add_flag("-q,--quiet", options->quiet, "Print errors and warnings only");
  added->footer(command.footer);
  added->callback([options, run = std::move(run)] { run(*options); });
}

void print_warnings(const std::vector<std::string>& warnings, const std::string& about) {
  for (const std::string& warning : warnings) {
    std::fprintf(stderr, "impactdic: warning: %s%s%s\n", about.c_str(), about.empty() ? "" : ": ",
                 warning.c_str());
  }
}

}  // namespace impactdic::app
